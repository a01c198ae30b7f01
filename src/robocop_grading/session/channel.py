"""The grader's end of the socket to a node's agent: frames out and in, without ever waiting for the node."""

import contextlib
import socket
from typing import Iterator, Tuple

from ..agent import wire
from ..errors import GraderLostError

MAX_FRAME = 8 * 1024**2  # bytes
MAX_UNSENT = 16 * 1024**2  # bytes that the node does not read
READ = 1 << 18  # bytes
UNREADABLE_ANSWER = "the node's answer to the grader can't be read"
NOT_READ = "the node does not read the answers of the services that it calls"


class Channel:
    """Transfers bytes only in `read` and `write`, which are called when the socket is ready."""

    def __init__(self, end: socket.socket) -> None:
        end.setblocking(False)
        self._socket = end
        self._unread, self.unsent = bytearray(), bytearray()
        self.is_open = True  # the node may send something

    def fileno(self) -> int:
        return self._socket.fileno()

    def send(self, kind: int, body: bytes) -> None:
        """Send a frame, or later what the socket has no room for; GraderLostError if the node reads nothing."""
        self.unsent += wire.frame(kind, body)
        self.write()
        if len(self.unsent) > MAX_UNSENT:
            raise GraderLostError(NOT_READ)

    def write(self) -> None:
        """Send the bytes that have not been sent yet."""
        with contextlib.suppress(OSError):  # it is full, or the node has ended
            del self.unsent[: self._socket.send(self.unsent)]

    def read(self) -> bool:
        """Take the bytes that have arrived; return whether there were any."""
        data = b""
        with contextlib.suppress(OSError):
            data = self._socket.recv(READ)
            self.is_open = bool(data)
        self._unread += data
        return bool(data)

    def frames(self) -> Iterator[Tuple[int, bytes]]:
        """The frames that have been read: kinds and bodies. GraderLostError for a frame that is too long."""
        while len(self._unread) >= wire.HEAD.size:
            size, kind = wire.HEAD.unpack_from(self._unread)
            end = wire.HEAD.size + size
            if size > MAX_FRAME:
                raise GraderLostError(UNREADABLE_ANSWER)
            if len(self._unread) < end:
                return
            body = bytes(self._unread[wire.HEAD.size : end])
            del self._unread[:end]
            yield kind, body

    def close(self) -> None:
        """Close the socket: nothing else is sent or read."""
        self.is_open = False
        self._socket.close()
