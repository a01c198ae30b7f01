"""A TF buffer that refuses transforms which cannot be right, and would hide or end what is right.

tf2's C++ core ends the process at some stamps instead of raising. It drops what is older than its newest transform of a
frame by more than its memory, so one transform dated far ahead silences the frame's real publisher. And it overwrites a
static transform, which nobody sends again, with any other one of the same child.
"""

from typing import Callable, Dict, Optional

import rospy
import tf2_ros
from geometry_msgs.msg import TransformStamped

from ...errors import FrameError
from .. import convert

STAMP_LIMIT = 2**31  # [s] from where the difference of two stamps can exceed a roscpp Duration (32 bits, signed)
# [s] A transform dated farther ahead than this drops those that are valid now. tf2's 10 s are not enough: at a hundred
# times real time, a busy machine delivers one topic many simulated seconds after another one, or after the clock.
MEMORY = 600.0
Clock = Callable[[], rospy.Time]


def is_possible(stamp: rospy.Time) -> bool:
    """Whether tf2 can compute with a stamp."""
    return bool(stamp.secs < STAMP_LIMIT)


class TfBuffer(tf2_ros.Buffer):
    """Refuses impossible transforms, with a warning; the latest possible ones stay in force.

    Localization dates its transforms a second or two into the future, which is possible: up to MEMORY.
    """

    def __init__(self, debug: bool = True, clock: Clock = rospy.get_rostime) -> None:
        """`debug`: as tf2's, whether to offer the service ~tf2_frames."""
        super().__init__(rospy.Duration.from_sec(MEMORY), debug)
        self._clock = clock
        self._placed_by: Dict[str, str] = {}  # static child frame -> the node that said where it is

    def set_transform(self, transform: TransformStamped, authority: str, is_static: bool = False) -> None:
        """Add a transform from /tf or /tf_static."""
        reason = self._reason_against(transform, authority, is_static)
        if reason is not None:
            frames = f"{transform.header.frame_id!r} -> {transform.child_frame_id!r}"
            rospy.logwarn_throttle(10.0, f"ignoring transform {frames} of {authority}: {reason}")
        elif is_static:
            self._placed_by[transform.child_frame_id] = authority
            super().set_transform_static(transform, authority)
        else:
            super().set_transform(transform, authority)

    def set_transform_static(self, transform: TransformStamped, authority: str) -> None:
        """Add a transform from /tf_static."""
        self.set_transform(transform, authority, is_static=True)

    def _reason_against(self, transform: TransformStamped, authority: str, is_static: bool) -> Optional[str]:
        """What is wrong with a transform; None: nothing."""
        stamp, shift = transform.header.stamp, transform.transform.translation
        if not is_possible(stamp):
            return f"its stamp of {stamp.secs} s is beyond {STAMP_LIMIT} s"
        try:
            convert.require_near(x=shift.x, y=shift.y, z=shift.z)
            convert.from_quaternion(transform.transform.rotation)
        except FrameError as error:
            return str(error)
        if is_static:
            return None
        now = self._clock()  # zero before the first message on /clock
        if now and stamp.to_sec() - now.to_sec() > MEMORY:
            return f"its stamp of {stamp.to_sec():.3f} s is more than {MEMORY:g} s ahead of {now.to_sec():.3f} s"
        placed_by = self._placed_by.get(transform.child_frame_id, authority)
        if placed_by != authority:
            return f"{placed_by} says on /tf_static where {transform.child_frame_id!r} is"
        return None
