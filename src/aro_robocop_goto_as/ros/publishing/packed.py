"""Messages of every step, serialized once; batch.c then writes the simulation's numbers into their bytes.

Building and serializing a message anew for each step was a quarter of the cost of a simulated second: genpy makes a
Python object of every number.
"""

import struct
from io import BytesIO
from typing import Any, List, NamedTuple, Optional, Sequence, Tuple

import genpy
import numpy as np
from geometry_msgs.msg import TransformStamped
from rosgraph_msgs.msg import Clock
from tf2_msgs.msg import TFMessage

from ...compiled import address
from ...geometry import Pose2D, Twist2D
from ...sensors.imu import FORCE, ORIENTATION, RATES
from ...sensors.scan_profiles import LidarSpec
from .. import convert
from ..covariances import ImuCovariances

HEADER, STAMP, POSE, TWIST, DOUBLES, FLOATS = range(6)  # kinds of fields, as in batch.c

_LENGTH = struct.Struct("<I")  # of a message, a string or a list
_HEADER = struct.calcsize("<III")  # bytes of seq, stamp.secs, stamp.nsecs; frame_id follows
_POSE = struct.calcsize("<7d")  # position or translation x y z, orientation x y z w
_COVARIANCE, _COVARIANCE_3 = 36 * 8, 9 * 8  # bytes
_SCAN_FIGURES = 7 * 4  # bytes of angle_min to range_max

Row = np.ndarray  # of an array of the simulation, which changes in place


def counter() -> np.ndarray:
    """The number (1,) of the last message of a topic."""
    return np.zeros(1, np.uint32)


def _string(text: str) -> int:
    """Bytes of a serialized string."""
    return _LENGTH.size + len(text.encode())


class Field(NamedTuple):
    """A part of a message that changes: what it is made of, and where it is."""

    kind: int
    offset: int  # bytes, from the message's length on
    source: Optional[np.ndarray]  # numbers of the simulation, as batch.c expects them for this kind

    @property
    def size(self) -> int:
        """The number of numbers in the source."""
        return 0 if self.source is None else len(self.source)

    @property
    def source_address(self) -> Optional[int]:
        """The address of the source, or None."""
        kind = np.uint32 if self.kind == HEADER else np.float64
        return None if self.source is None else address("source", self.source, (None,), kind)


class PackedMessage:
    """The bytes of a message as they are sent: its length, then its fields. Latched, it is the message sent last."""

    def __init__(self, template: genpy.Message, fields: Sequence[Field] = ()) -> None:
        serialized = BytesIO()
        template.serialize(serialized)
        body = serialized.getvalue()
        self.data = np.frombuffer(_LENGTH.pack(len(body)) + body, np.uint8).copy()
        self.size = len(self.data)
        self.fields = tuple(fields)
        self.address = address("data", self.data, (None,), np.uint8)

    def body(self) -> bytes:
        """The serialized message, without its length."""
        return self.data[_LENGTH.size :].tobytes()

    def serialize(self, buff: Any) -> None:
        """As genpy's messages do it."""
        buff.write(self.body())


def packed_clock() -> PackedMessage:
    """A message on /clock."""
    return PackedMessage(Clock(), [Field(STAMP, _LENGTH.size, None)])


def packed_scan(spec: LidarSpec, frame: str, ranges: Row, number: Optional[np.ndarray]) -> PackedMessage:
    """The ranges (n_beams,) [m] of one scanner; `number`: a counter, None: all have number 0."""
    template = convert.to_scan(np.zeros(len(ranges)), spec, genpy.Time(), frame)
    start = _LENGTH.size + _HEADER + _string(frame) + _SCAN_FIGURES + _LENGTH.size
    return PackedMessage(template, [Field(HEADER, _LENGTH.size, number), Field(FLOATS, start, ranges)])


def packed_odometry(frame: str, child: str, covariance: List[float], pose: Row, twist: Row) -> PackedMessage:
    """Pose (3,) of `child` in `frame` with the twist (2,) in `child`; one covariance (36,) serves both."""
    template = convert.to_odometry(Pose2D(), Twist2D(), genpy.Time(), frame, child, covariance)
    start = _LENGTH.size + _HEADER + _string(frame) + _string(child)
    fields = [Field(POSE, start, pose), Field(TWIST, start + _POSE + _COVARIANCE, twist)]
    return PackedMessage(template, [Field(HEADER, _LENGTH.size, counter()), *fields])


def packed_joint_state(angles: Row, speeds: Row) -> PackedMessage:
    """Wheel angles (2,) [rad] and speeds (2,) [rad/s], left and right."""
    template = convert.to_joint_state((0.0, 0.0), (0.0, 0.0), genpy.Time())
    start = _LENGTH.size + _HEADER + _string("") + _LENGTH.size + sum(map(_string, template.name)) + _LENGTH.size
    fields = [Field(DOUBLES, start, angles), Field(DOUBLES, start + 2 * 8 + _LENGTH.size, speeds)]
    return PackedMessage(template, [Field(HEADER, _LENGTH.size, counter()), *fields])


def packed_imu(frame: str, covariances: ImuCovariances, sample: Row) -> PackedMessage:
    """A sample (10,) of sensors.imu, with constant covariances."""
    template = convert.to_imu(sample, genpy.Time(), frame, covariances)
    start = _LENGTH.size + _HEADER + _string(frame)
    fields = [Field(HEADER, _LENGTH.size, counter())]
    for part, covariance in ((ORIENTATION, _COVARIANCE_3), (RATES, _COVARIANCE_3), (FORCE, 0)):
        fields.append(Field(DOUBLES, start, sample[part]))
        start += sample[part].nbytes + covariance
    return PackedMessage(template, fields)


def packed_transforms(transforms: Sequence[Tuple[str, str, Row]]) -> PackedMessage:
    """One /tf message with transforms: parent, child, and parent_from_child (3,)."""
    template: List[TransformStamped] = []
    fields, start = [], 2 * _LENGTH.size
    for parent, child, pose in transforms:
        template.append(convert.to_transform(parent, child, Pose2D(), genpy.Time()))
        fields.append(Field(HEADER, start, None))
        start += _HEADER + _string(parent) + _string(child)
        fields.append(Field(POSE, start, pose))
        start += _POSE
    return PackedMessage(TFMessage(template), fields)
