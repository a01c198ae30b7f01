"""Counts the messages in the bytes of a topic's connection, with the stamps of the first and the last one.

A frame is a length of four bytes, little-endian, then the message; all messages here begin with a std_msgs/Header: seq,
secs, nsecs. https://wiki.ros.org/ROS/Connection%20Header, https://wiki.ros.org/ROS/TCPROS
"""

import struct
from dataclasses import dataclass
from typing import Mapping, Optional, Tuple

from ..errors import BenchError
from ..simulation.clock import NANOSECONDS

_LENGTH, _START = struct.Struct("<I"), struct.Struct("<IIII")  # length; length, seq, secs, nsecs
ROUNDING = 2  # [ns]
_STAMP_BYTES = _START.size - _LENGTH.size


def framed(message: bytes) -> bytes:
    """A serialised message as it is sent over a connection."""
    return _LENGTH.pack(len(message)) + message


@dataclass(frozen=True)
class Count:
    """The number of messages of one topic, and the stamps [ns] of the first and the last."""

    messages: int = 0
    first_ns: Optional[int] = None
    last_ns: Optional[int] = None


class FrameCounter:
    """Counts the messages in a stream that arrives in pieces of any size."""

    def __init__(self) -> None:
        self.messages = 0
        self._rest = b""  # the beginning of an incomplete frame
        self._first: Optional[int] = None
        self._last: Optional[int] = None

    @property
    def count(self) -> Count:
        """The messages so far."""
        return Count(self.messages, self._first, self._last)

    def feed(self, data: bytes) -> None:
        """Count the messages that these bytes complete; BenchError on a message too short for a header."""
        if self._rest:
            data = self._rest + data
        at = newest = 0
        while len(data) - at >= _LENGTH.size:
            length = _LENGTH.unpack_from(data, at)[0]
            if length < _STAMP_BYTES:
                raise BenchError(f"a message of {length} bytes, expected one that begins with a header")
            if at + _LENGTH.size + length > len(data):
                break
            if not self.messages:
                self._first = _stamp(data, at)
            self.messages += 1
            newest, at = at, at + _LENGTH.size + length
        if at:
            self._last = _stamp(data, newest)
            data = data[at:]
        self._rest = data


def _stamp(data: bytes, at: int) -> int:
    """The stamp [ns] of the message whose frame starts at this offset."""
    _, _, secs, nsecs = _START.unpack_from(data, at)
    return int(secs * NANOSECONDS + nsecs)


def deliveries(counts: Mapping[str, Count], rates: Mapping[str, int]) -> Tuple[int, int]:
    """Numbers of messages expected and delivered on topics with these rates [Hz], from each first to the newest stamp.

    Messages with the newest stamp are not counted: the simulator may have been ended while it sent them.
    """
    newest = max((count.last_ns or 0 for count in counts.values()), default=0)
    expected = delivered = 0
    for topic, rate in rates.items():
        count = counts[topic]
        if count.first_ns is not None:
            # Stamps are rounded down to nanoseconds: one that seems ROUNDING too early is the newest itself.
            expected += max(0, -(-(newest - count.first_ns - ROUNDING) * rate // NANOSECONDS))
            delivered += count.messages - (count.last_ns == newest)
    return expected, delivered
