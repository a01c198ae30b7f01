"""Odometry whose bytes are laid out once: with many robots, building and serialising it anew was most of the cost.

Messages that follow each other faster also find their reader awake, which makes each write to its socket cheaper.
"""

import math
import struct
from io import BytesIO
from typing import Any, List

from genpy import Time
from nav_msgs.msg import Odometry

from ..geometry import Pose2D, Twist2D
from . import convert

_HEAD = struct.Struct("<III")  # seq, stamp.secs, stamp.nsecs
_POSE = struct.Struct("<7d")  # position x y z, orientation x y z w
_TWIST = struct.Struct("<6d")  # linear x y z, angular x y z
_STRING = 4  # bytes of a string's length
_COVARIANCE = 36 * 8  # bytes


class PackedOdometry(Odometry):
    """Pose of `child` in `frame` with the twist in `child`; one covariance (36,) serves both.

    rospy takes it for an Odometry, but only `serialize` works, for it has no fields of its own.
    """

    __slots__ = ["_bytes", "_pose_at", "_seq"]
    _has_header = False  # so that rospy leaves its sequence number to us

    def __init__(self, frame: str, child: str, covariance: List[float]) -> None:
        buffer = BytesIO()
        convert.to_odometry(Pose2D(), Twist2D(), Time(), frame, child, covariance).serialize(buffer)
        self._bytes = bytearray(buffer.getvalue())
        self._pose_at = _HEAD.size + _STRING + len(frame.encode()) + _STRING + len(child.encode())
        self._seq = 0

    def update(self, pose: Pose2D, twist: Twist2D, stamp: Time) -> "PackedOdometry":
        """The same message with other numbers; it may be published again at once, as our publishers are synchronous."""
        self._seq += 1
        half = pose.yaw / 2.0
        _HEAD.pack_into(self._bytes, 0, self._seq, stamp.secs, stamp.nsecs)
        _POSE.pack_into(self._bytes, self._pose_at, pose.x, pose.y, 0.0, 0.0, 0.0, math.sin(half), math.cos(half))
        _TWIST.pack_into(self._bytes, self._pose_at + _POSE.size + _COVARIANCE, twist.v, 0.0, 0.0, 0.0, 0.0, twist.w)
        return self

    def serialize(self, buff: Any) -> None:
        """As genpy's messages do it."""
        buff.write(self._bytes)
