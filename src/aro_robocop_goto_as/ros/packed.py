"""Messages of every step, serialized once and then updated in place, for `outbox` and `publishing.send`.

Building and serializing a message anew for each step was a quarter of the cost of a simulated second: genpy makes a
Python object of every number. Here NumPy and struct write the numbers into the bytes that go to the sockets.
"""

import ctypes
import itertools
import math
import struct
from io import BytesIO
from typing import Iterator, List, Optional, Sequence, Tuple

import genpy
import numpy as np
from geometry_msgs.msg import TransformStamped
from nav_msgs.msg import Odometry
from rosgraph_msgs.msg import Clock
from sensor_msgs.msg import Imu, JointState, LaserScan
from tf2_msgs.msg import TFMessage

from ..geometry import Pose2D, Twist2D
from ..robot.model import RobotState
from ..sensors.imu import ImuSample
from ..sensors.scan_profiles import LidarSpec
from ..simulation.clock import NANOSECONDS
from . import convert

_LENGTH = struct.Struct("<I")  # of a message, a string or a list
_HEADER = struct.Struct("<III")  # seq, stamp.secs, stamp.nsecs; frame_id follows
_STAMP = struct.Struct("<II")
_POSE = struct.Struct("<7d")  # position or translation x y z, orientation x y z w
_TWIST = struct.Struct("<6d")  # linear x y z, angular x y z
_PAIR = struct.Struct("<2d")
_SCAN_FIGURES = 7 * 4  # bytes of angle_min to range_max
_COVARIANCE = 36 * 8  # bytes
_COVARIANCE_3 = 9 * 8  # bytes

Stamp = Tuple[int, int]  # seconds, nanoseconds


def stamp_of(stamp_ns: int) -> Stamp:
    """Simulated time [ns] as the two numbers of a ROS time."""
    return divmod(stamp_ns, NANOSECONDS)


def _string(text: str) -> int:
    """Bytes of a serialized string."""
    return _LENGTH.size + len(text.encode())


class PackedMessage:
    """The bytes of a message as they are sent: its length, then its fields."""

    def __init__(self, template: genpy.Message) -> None:
        serialized = BytesIO()
        template.serialize(serialized)
        body = serialized.getvalue()
        self.data = bytearray(_LENGTH.pack(len(body)) + body)
        self.size = len(self.data)
        self._start = ctypes.c_char.from_buffer(self.data)  # while it exists, the bytes stay where they are
        self.address = ctypes.addressof(self._start)


class _Stamped(PackedMessage):
    """A message that starts with a header; `_fields` is where the fields after it start."""

    def __init__(self, template: genpy.Message, frame: str, numbers: Optional[Iterator[int]] = None) -> None:
        """`numbers`: the header's sequence number in each message to come."""
        super().__init__(template)
        self._numbers = numbers or itertools.count(1)
        self._fields = _LENGTH.size + _HEADER.size + _string(frame)

    def _set_header(self, stamp: Stamp) -> None:
        _HEADER.pack_into(self.data, _LENGTH.size, next(self._numbers) % 2**32, *stamp)


class PackedClock(PackedMessage):
    """/clock."""

    def __init__(self) -> None:
        super().__init__(Clock())

    def update(self, stamp: Stamp) -> "PackedClock":
        """The message with a new time."""
        _STAMP.pack_into(self.data, _LENGTH.size, *stamp)
        return self


class PackedScan(_Stamped):
    """The ranges of one scanner, always the same number; `numbers` as in _Stamped."""

    def __init__(self, spec: LidarSpec, frame: str, numbers: Optional[Iterator[int]] = None) -> None:
        template: LaserScan = convert.to_scan(np.zeros(spec.samples), spec, genpy.Time(), frame)
        super().__init__(template, frame, numbers)
        start = self._fields + _SCAN_FIGURES + _LENGTH.size
        self._ranges = np.frombuffer(self.data, "<f4", spec.samples, start)

    def update(self, ranges: np.ndarray, stamp: Stamp) -> "PackedScan":
        """The message with new ranges (n_beams,) [m]."""
        self._set_header(stamp)
        self._ranges[:] = ranges
        return self


class PackedOdometry(_Stamped):
    """Pose of `child` in `frame` with the twist in `child`; one covariance (36,) serves both."""

    def __init__(self, frame: str, child: str, covariance: List[float]) -> None:
        template: Odometry = convert.to_odometry(Pose2D(), Twist2D(), genpy.Time(), frame, child, covariance)
        super().__init__(template, frame)
        self._pose = self._fields + _string(child)
        self._twist = self._pose + _POSE.size + _COVARIANCE

    def update(self, pose: Pose2D, twist: Twist2D, stamp: Stamp) -> "PackedOdometry":
        """The message with a new pose and twist."""
        self._set_header(stamp)
        _pack_pose(self.data, self._pose, pose)
        _TWIST.pack_into(self.data, self._twist, twist.v, 0.0, 0.0, 0.0, 0.0, twist.w)
        return self


class PackedJointState(_Stamped):
    """Angles and velocities of the wheels."""

    def __init__(self) -> None:
        template: JointState = convert.to_joint_state((0.0, 0.0), (0.0, 0.0), genpy.Time())
        super().__init__(template, "")
        names = _LENGTH.size + sum(map(_string, template.name))
        self._angles = self._fields + names + _LENGTH.size
        self._velocities = self._angles + _PAIR.size + _LENGTH.size

    def update(self, state: RobotState, stamp: Stamp) -> "PackedJointState":
        """The message with a new state."""
        self._set_header(stamp)
        _PAIR.pack_into(self.data, self._angles, *state.wheel_angles)
        _PAIR.pack_into(self.data, self._velocities, *state.wheel_velocities)
        return self


class PackedImu(_Stamped):
    """Orientation, rates and accelerations with constant covariances."""

    def __init__(self, frame: str, covariances: convert.ImuCovariances) -> None:
        zeros = np.zeros(3)
        template: Imu = convert.to_imu(ImuSample((0.0, 0.0, 0.0, 1.0), zeros, zeros), genpy.Time(), frame, covariances)
        super().__init__(template, frame)
        rates = self._fields + 4 * 8 + _COVARIANCE_3
        accelerations = rates + 3 * 8 + _COVARIANCE_3
        self._orientation, self._rates, self._accelerations = (
            np.frombuffer(self.data, "<f8", size, start)
            for size, start in ((4, self._fields), (3, rates), (3, accelerations))
        )

    def update(self, sample: ImuSample, stamp: Stamp) -> "PackedImu":
        """The message with a new sample."""
        self._set_header(stamp)
        self._orientation[:] = sample.orientation
        self._rates[:] = sample.angular_velocity
        self._accelerations[:] = sample.linear_acceleration
        return self


class PackedTransforms(PackedMessage):
    """One /tf message with transforms between fixed pairs of frames."""

    def __init__(self, frames: Sequence[Tuple[str, str]]) -> None:
        """`frames`: parent and child of each transform."""
        transforms: List[TransformStamped] = [
            convert.to_transform(parent, child, Pose2D(), genpy.Time()) for parent, child in frames
        ]
        super().__init__(TFMessage(transforms))
        self._starts: List[Tuple[int, int]] = []  # of each transform's header and pose
        start = 2 * _LENGTH.size
        for parent, child in frames:
            pose = start + _HEADER.size + _string(parent) + _string(child)
            self._starts.append((start, pose))
            start = pose + _POSE.size

    def update(self, poses: Sequence[Pose2D], stamp: Stamp) -> "PackedTransforms":
        """The message with a new parent_from_child of each pair."""
        for (header, at), pose in zip(self._starts, poses):
            _HEADER.pack_into(self.data, header, 0, *stamp)
            _pack_pose(self.data, at, pose)
        return self


def _pack_pose(data: bytearray, start: int, pose: Pose2D) -> None:
    half = pose.yaw / 2.0
    _POSE.pack_into(data, start, pose.x, pose.y, 0.0, 0.0, 0.0, math.sin(half), math.cos(half))
