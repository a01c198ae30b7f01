"""Messages of one step, sent together: one call writes them all to the sockets of their subscribers.

rospy's way to a socket costs about as much Python as making the message: a lock, a test of the connection's state and
a system call that releases and takes the interpreter's lock, for each message and each subscriber.
"""

import ctypes
import errno
import functools
from array import array
from contextlib import suppress
from typing import List, Tuple

from .. import compiled
from .packed import PackedMessage
from .private_api import count_message, count_sent
from .publishing import DirectPublisher, Outlet

VERSION = 1  # of sender.c
LATER = (-errno.EAGAIN, -errno.EWOULDBLOCK)  # the subscriber's socket takes nothing at the moment


@functools.lru_cache(maxsize=None)
def _library() -> ctypes.PyDLL:
    library = compiled.load("sender", VERSION)
    library.aro_send.restype = ctypes.c_int64
    library.aro_send.argtypes = [ctypes.c_int64] + [ctypes.c_void_p] * 4
    return library


class Outbox:
    """Used by one thread, for topics on which no other thread publishes and that are not latched."""

    def __init__(self) -> None:
        self._messages: List[Tuple[DirectPublisher, PackedMessage]] = []
        self._send = _library().aro_send

    def put(self, topic: DirectPublisher, message: PackedMessage) -> None:
        """Send a message with the next flush(). It must not be updated before."""
        self._messages.append((topic, message))

    def flush(self) -> None:
        """Send everything, in the order in which it was put in.

        A subscriber that does not take its message within publishing.STALL_LIMIT is disconnected.
        """
        outlets: List[Outlet] = []
        messages: List[PackedMessage] = []
        for topic, message in self._messages:
            count_message(topic, message.size)
            for outlet in topic.outlets:
                outlets.append(outlet)
                messages.append(message)
        self._messages.clear()
        if len(outlets) == 1:  # for one message the arrays cost more than the call saves
            _finish(outlets[0], messages[0], 0)
            return
        sockets = array("i", [outlet.descriptor for outlet in outlets])
        data = array("Q", [message.address for message in messages])
        sizes = array("q", [message.size for message in messages])
        taken = array("q", sizes)
        if not self._send(len(outlets), *(numbers.buffer_info()[0] for numbers in (sockets, data, sizes, taken))):
            for outlet, size in zip(outlets, sizes):
                count_sent(outlet.connection, size)
            return
        for outlet, message, count in zip(outlets, messages, taken):
            _finish(outlet, message, count)


def _finish(outlet: Outlet, message: PackedMessage, taken: int) -> None:
    """Send the rest of a message of which `taken` bytes were sent, or disconnect the subscriber on an error -taken."""
    try:
        if taken < 0 and taken not in LATER:
            raise OSError(-taken, "send")
        if taken < message.size:
            outlet.socket.sendall(memoryview(message.data)[max(0, taken) :])
    except OSError:
        with suppress(Exception):  # as rospy: this subscriber is lost, and only this one
            outlet.connection.close()
    else:
        count_sent(outlet.connection, message.size)
