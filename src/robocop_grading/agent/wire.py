"""The messages between grader and agent: frames on a socket, each with its length, its kind and its body.

grader -> agent
    SETUP     the node's parameters, and headers of connections, pickled
    TOPIC     the header of one more connection, pickled
    GO        until when [ns since the node's start], /clock [ns], messages
    REPLY     a service's response as on TCPROS
agent -> grader
    MESSAGE   a topic, and bytes of the stream of its messages
    CALL      a service, and the request as on TCPROS; a REPLY follows
    TOPICS    the node's topics, the programs of ROS that the node has started, and delays, as JSON
    DONE      until when [ns], and when the node next does something by itself [ns]
"""

import struct
from typing import Iterable, Iterator, Tuple

SETUP, TOPIC, GO, REPLY, MESSAGE, CALL, TOPICS, DONE = range(8)
HEAD = struct.Struct("<IB")  # of a frame: bytes of its body, kind
LENGTH = struct.Struct("<I")  # of a message, as on TCPROS
TIMES = struct.Struct("<qq")  # of GO and of DONE
_NAME = struct.Struct("<H")

Message = Tuple[str, bytes]  # a topic, and what is sent on it, with its length


def frame(kind: int, body: bytes) -> bytes:
    """Make a frame, as it is sent."""
    return HEAD.pack(len(body), kind) + body


def named(name: str, data: bytes) -> bytes:
    """Make a body that begins with a name."""
    text = name.encode()
    return _NAME.pack(len(text)) + text + data


def split(body: bytes) -> Tuple[str, bytes]:
    """The name at the beginning of a body, and the rest; struct.error or UnicodeError if there is no name."""
    (size,) = _NAME.unpack_from(body)
    start = _NAME.size + size
    return body[_NAME.size : start].decode(), body[start:]


def go(until_ns: int, clock_ns: int, messages: Iterable[Message]) -> bytes:
    """The body of GO."""
    parts = [TIMES.pack(until_ns, clock_ns)]
    for topic, data in messages:
        part = named(topic, data)
        parts += [LENGTH.pack(len(part)), part]
    return b"".join(parts)


def messages_of(body: bytes) -> Iterator[Message]:
    """The messages in the body of GO."""
    start = TIMES.size
    while start < len(body):
        (size,) = LENGTH.unpack_from(body, start)
        start += LENGTH.size
        yield split(body[start : start + size])
        start += size
