"""Where frames are, by tf2."""

from typing import Optional, Set

import rospy
import tf2_ros
from geometry_msgs.msg import TransformStamped

from ...geometry import Pose3D
from ..client.goal_frame import MAX_STAMP
from ..marker_shapes import to_pose

LATEST = rospy.Time(0)
MAX_LEAD = 2.0  # [s] between the stamps of two transforms that follow each other; a larger step back is a restart


class Frames:
    """A buffer of tf2. It begins anew when time is set back, as by a restart of the simulator."""

    def __init__(self) -> None:
        self._buffer = tf2_ros.BufferCore()
        self._names: Set[str] = set()
        self._newest = 0.0  # [s] stamp

    def update(self, stamped: TransformStamped, is_static: bool = False) -> None:
        """Store a transform; tf2 logs why if it can't be used."""
        stamp = stamped.header.stamp.to_sec()
        if is_static:
            self._buffer.set_transform_static(stamped, "")
        else:
            if stamp < self._newest - MAX_LEAD:
                self._buffer.clear()  # static transforms stay
                self._newest = stamp
            self._newest = max(self._newest, stamp)
            self._buffer.set_transform(stamped, "")
        self._names |= {stamped.header.frame_id.lstrip("/"), stamped.child_frame_id.lstrip("/")}

    def knows(self, frame: str) -> bool:
        """Return whether a transform to or from the frame has been received."""
        return frame in self._names

    def lookup(self, target: str, source: str, stamp: rospy.Time = LATEST) -> Optional[Pose3D]:
        """target_from_source at a stamp; None if tf2 does not know it, or not yet."""
        if stamp.secs > MAX_STAMP:
            return None
        try:
            found = self._buffer.lookup_transform_core(target, source, stamp).transform
        except tf2_ros.TransformException:
            return None
        return to_pose(found.translation, found.rotation)
