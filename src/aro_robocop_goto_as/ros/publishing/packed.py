"""Messages of every step, serialized once; batch.c then writes the simulation's numbers into their bytes.

Building and serializing a message anew for each step was a quarter of the cost of a simulated second: genpy makes a
Python object of every number.
"""

import struct
from io import BytesIO
from typing import Any, Dict, Mapping, NamedTuple, Optional, Tuple

import genpy
import numpy as np

from ...compiled import address

HEADER, STAMP, POSE, TWIST, DOUBLES, FLOATS = range(6)  # kinds of fields, as in batch.c
KINDS = {  # by the types that message definitions name
    "std_msgs/Header": HEADER,
    "time": STAMP,
    "geometry_msgs/Pose": POSE,
    "geometry_msgs/Transform": POSE,
    "geometry_msgs/Twist": TWIST,
    "geometry_msgs/Quaternion": DOUBLES,
    "geometry_msgs/Vector3": DOUBLES,
    "float64[]": DOUBLES,
    "float32[]": FLOATS,
    "float32": FLOATS,
}
# Bytes of built-in types, http://wiki.ros.org/msg#Fields; a string and a list without a fixed size begin with a length.
SIZES = {"bool": 1, "byte": 1, "char": 1, "int8": 1, "uint8": 1, "int16": 2, "uint16": 2, "int32": 4, "uint32": 4}
SIZES.update(int64=8, uint64=8, float32=4, float64=8, time=8, duration=8)

_LENGTH = struct.Struct("<I")  # of a message, a string or a list


def counter() -> np.ndarray:
    """The number (1,) of the last message of a topic."""
    return np.zeros(1, np.uint32)


class Field(NamedTuple):
    """A part of a message that changes: the source of its numbers, and its place in the message."""

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


def places(message: genpy.Message) -> Dict[str, Tuple[str, int]]:
    """The type of each part of a message, and the byte at which its numbers begin in the serialized message.

    Parts are named as in Python, such as "pose.pose" or "transforms[0].header".
    """
    found: Dict[str, Tuple[str, int]] = {}
    _walk(message, message._type, "", 0, found)
    return found


def _walk(value: Any, kind: str, path: str, start: int, found: Dict[str, Tuple[str, int]]) -> int:
    """Note the parts of a value that begins at a byte; returns the byte at which the value ends."""
    base, is_list, size = kind.partition("[")
    if kind == "string" or size == "]":
        start += _LENGTH.size
    found[path] = kind, start
    if is_list:
        for index, item in enumerate(value):
            start = _walk(item, base, f"{path}[{index}]", start, found)
        return start
    if kind == "string":
        return start + len(value.encode())
    if kind in SIZES:
        return start + SIZES[kind]
    for name, part in zip(value.__slots__, value._slot_types):
        start = _walk(getattr(value, name), part, f"{path}.{name}" if path else name, start, found)
    return start


class PackedMessage:
    """The bytes of a message as they are sent: its length, then its fields. If latched, the last message."""

    def __init__(self, template: genpy.Message, sources: Optional[Mapping[str, Optional[np.ndarray]]] = None) -> None:
        """`sources`: numbers of the simulation for the parts of the message that change, named as in places().

        The source of a header is the counter of the topic's messages; None: all messages have number 0.
        """
        serialized = BytesIO()
        template.serialize(serialized)
        body = serialized.getvalue()
        self.data = np.frombuffer(_LENGTH.pack(len(body)) + body, np.uint8).copy()
        self.size = len(self.data)
        found = places(template) if sources else {}
        self.fields = tuple(
            Field(KINDS[found[path][0]], _LENGTH.size + found[path][1], source)
            for path, source in (sources or {}).items()
        )
        self.address = address("data", self.data, (None,), np.uint8)

    def body(self) -> bytes:
        """The serialized message, without its length."""
        return self.data[_LENGTH.size :].tobytes()

    def serialize(self, buff: Any) -> None:
        """Write the serialized message to a buffer, as genpy's messages do."""
        buff.write(self.body())
