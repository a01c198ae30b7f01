"""Messages of every step, serialized once; batch.c then writes the simulation's numbers into their bytes.

Building and serializing a message anew for each step was a quarter of the cost of a simulated second: genpy makes a
Python object of every number.
"""

import struct
from io import BytesIO
from typing import Any, NamedTuple, Optional, Sequence

import genpy
import numpy as np

from ...compiled import address

HEADER, STAMP, POSE, TWIST, DOUBLES, FLOATS = range(6)  # kinds of fields, as in batch.c

_LENGTH = struct.Struct("<I")  # of a message, a string or a list


def counter() -> np.ndarray:
    """The number (1,) of the last message of a topic."""
    return np.zeros(1, np.uint32)


def string_size(text: str) -> int:
    """Bytes of a serialized string."""
    return _LENGTH.size + len(text.encode())


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


class PackedMessage:
    """The bytes of a message as they are sent: its length, then its fields. If latched, the last message."""

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
        """Write the serialized message to a buffer, as genpy's messages do."""
        buff.write(self.body())
