"""Messages of one step, sent together: one call writes them all to the sockets of their subscribers.

rospy's way to a socket costs about as much Python as making the message: a lock, a test of the connection's state and
a system call that releases and takes the interpreter's lock, for each message and each subscriber.
"""

import ctypes
import errno
import functools
import socket
from array import array
from typing import List, Sequence, Tuple

from .. import compiled
from .packed import PackedMessage
from .private_api import count_message, count_sent, disconnect
from .publishing import DirectPublisher, Outlet

VERSION = 2  # of sender.c
Send = Tuple[DirectPublisher, Outlet, PackedMessage]
LATER = (-errno.EAGAIN, -errno.EWOULDBLOCK)  # the subscriber's socket takes nothing at the moment


@functools.lru_cache(maxsize=None)
def _library() -> ctypes.PyDLL:
    library = compiled.load("sender", VERSION)
    library.aro_send.restype = None
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

        A subscriber that takes nothing for publishing.STALL_LIMIT is disconnected. While one is waited for, that time
        passes for the others, too: a stopped node can have many topics.
        """
        for topic, message in self._messages:
            count_message(topic, message.size)
        sends = [(topic, outlet, message) for topic, message in self._messages for outlet in topic.outlets]
        self._messages.clear()
        if len(sends) == 1 or len({outlet.connection for _, outlet, _ in sends}) < len(sends):
            # For one message the arrays cost more than the call saves. In one call, the second of two messages on one
            # connection (of topics remapped to one) could come between the parts of the first.
            counts: Sequence[int] = [0] * len(sends)
        else:
            counts = self._send_at_once(sends)
        patient = True
        for send, taken in zip(sends, counts):
            _, outlet, message = send
            if taken == message.size:
                count_sent(outlet.connection, taken)
            else:
                patient = _finish(send, taken, patient) and patient

    def _send_at_once(self, sends: Sequence[Send]) -> Sequence[int]:
        """How many bytes of each message were sent without waiting, or -errno."""
        sockets = array("i", [outlet.descriptor for _, outlet, _ in sends])
        data = array("Q", [message.address for _, _, message in sends])
        sizes = array("q", [message.size for _, _, message in sends])
        taken = array("q", sizes)
        self._send(len(sends), *(numbers.buffer_info()[0] for numbers in (sockets, data, sizes, taken)))
        return taken


def _finish(send: Send, taken: int, patient: bool) -> bool:
    """Send the rest of a message of which `taken` bytes were sent, or disconnect the subscriber on an error -taken.

    Returns False if the subscriber has stalled: without patience at once, if it takes nothing more.
    """
    topic, outlet, message = send
    try:
        if taken < 0 and taken not in LATER:
            raise OSError(-taken, "send")
        rest = memoryview(message.data)[max(0, taken) :]
        if not patient:
            rest = rest[outlet.socket.send(rest, socket.MSG_DONTWAIT) :]
        outlet.socket.sendall(rest)
    except OSError as error:  # as rospy: this subscriber is lost, and only this one
        disconnect(topic, outlet.connection)
        return not isinstance(error, BlockingIOError)
    count_sent(outlet.connection, message.size)
    return True
