"""A socket without a network, from which rospy reads and to which it writes."""

import _thread
import errno
import os
from typing import Any, Callable, Dict, Optional

from .scheduler import NEVER, Waiter, scheduler

Header = Dict[str, str]  # of a connection, as on TCPROS


class MemorySocket:
    """One end of a connection, in place of a socket: holds the bytes that have arrived, and hands on what is sent."""

    def __init__(self, send: Callable[[bytes], object], sends_header: bool = True) -> None:
        """`sends_header`: whether the connection's header, which rospy sends first, is handed on, too."""
        self._send, self._sends = send, sends_header
        self._data = bytearray()
        self._reader: Optional[Waiter] = None
        self.on_close: Callable[[], object] = lambda: None
        self.is_open = True
        self._since_ns = 0  # when the unread bytes began to arrive

    @property
    def waiting_ns(self) -> int:
        """How long [ns] the oldest unread byte has waited."""
        return scheduler.now_ns - self._since_ns if self._data and self.is_open else 0

    def feed(self, data: bytes) -> None:
        """Append bytes that have arrived, and wake the thread that waits for them."""
        with scheduler.guard:
            self._since_ns = self._since_ns if self._data else scheduler.now_ns
            self._data += data
            self._wake()

    def end(self) -> None:
        """The other end has closed: nothing else arrives, and what is sent is an error."""
        with scheduler.guard:
            self.is_open = False
            self._wake()

    def _wake(self) -> None:
        if self._reader is not None and not self._reader.awake:
            scheduler.wake(self._reader)

    # -- what rospy uses of a socket --

    def recv(self, size: int) -> bytes:
        while True:
            with scheduler.guard:
                if self._data or not self.is_open:
                    data = bytes(self._data[:size])
                    del self._data[:size]
                    return data
                waiter = self._reader = scheduler.new_waiter()
                scheduler.park(waiter, NEVER)
            scheduler.wait(waiter)

    def sendall(self, data: bytes) -> None:
        if not self.is_open:
            raise OSError(errno.EPIPE, os.strerror(errno.EPIPE))
        if self._sends:
            self._send(bytes(data))
        self._sends = True

    def fileno(self) -> None:
        """Return no number: rospy polls only ends of connections that have a number."""

    def getsockname(self) -> Any:
        return "localhost", 0

    def setblocking(self, *_: object) -> None:
        pass

    setsockopt = setblocking

    def close(self) -> None:
        if self.is_open:
            self.end()
            self.on_close()


def encoded(header: Header) -> bytes:
    from rosgraph.network import encode_ros_handshake_header

    return bytes(encode_ros_handshake_header(header))


def accept(end: MemorySocket) -> None:
    """Have the node's server handle a connection, in a thread of its own."""
    from rospy.impl import tcpros_base

    _thread.start_new_thread(tcpros_base._tcpros_server._tcp_server_callback, (end, ("localhost", 0)))
