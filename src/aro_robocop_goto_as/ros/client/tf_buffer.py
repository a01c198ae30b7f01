"""A TF buffer that refuses impossible stamps, at which tf2's C++ core ends the process instead of raising."""

import rospy
import tf2_ros
from geometry_msgs.msg import TransformStamped

STAMP_LIMIT = 2**31  # [s] from where the difference of two stamps can exceed a roscpp Duration (32 bits, signed)


def is_possible(stamp: rospy.Time) -> bool:
    """Whether tf2 can compute with a stamp."""
    return bool(stamp.secs < STAMP_LIMIT)


class TfBuffer(tf2_ros.Buffer):
    """Refuses transforms with impossible stamps; the latest possible ones stay in force."""

    def set_transform(self, transform: TransformStamped, authority: str, is_static: bool = False) -> None:
        """Add a transform from /tf or /tf_static."""
        header = transform.header
        if not is_possible(header.stamp):
            rospy.logwarn_throttle(
                10.0,
                f"ignoring transform {header.frame_id!r} -> {transform.child_frame_id!r} of {authority}: its stamp of "
                f"{header.stamp.secs} s is beyond {STAMP_LIMIT} s",
            )
        elif is_static:
            super().set_transform_static(transform, authority)
        else:
            super().set_transform(transform, authority)

    def set_transform_static(self, transform: TransformStamped, authority: str) -> None:
        """Add a transform from /tf_static."""
        self.set_transform(transform, authority, is_static=True)
