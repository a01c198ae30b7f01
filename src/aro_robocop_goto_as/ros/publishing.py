"""Publishers that lose nothing: each message is written to its subscribers before the next step is simulated."""

import errno
import socket
import struct
import threading
import warnings
from contextlib import suppress
from typing import Any, Callable, List, NamedTuple, Optional, Tuple

import rospy

from .rospy_internals import connections_of

STALL_LIMIT = 2  # [s, wall] after which a subscriber that accepts no data is disconnected, so that it cannot block us


class Outlet(NamedTuple):
    """A subscriber's connection, with a duplicate of its socket that stays open even if the connection is closed."""

    connection: Any
    socket: socket.socket
    descriptor: int


class DirectPublisher(rospy.Publisher):
    """A synchronous publisher: no queue that drops messages, no thread per topic, back-pressure instead of loss."""

    def __init__(self, topic: str, kind: Any, latch: bool, on_change: Callable[[], None]) -> None:
        self.outlets: Tuple[Outlet, ...] = ()
        self._outlets_lock = threading.Lock()

        def changed() -> None:
            self._update_outlets()
            on_change()

        listener = rospy.SubscribeListener()
        listener.peer_subscribe = listener.peer_unsubscribe = lambda *_: changed()
        super().__init__(topic, kind, subscriber_listener=listener, latch=latch, queue_size=None)
        changed()  # for a subscriber that connected before the listener was there

    def _update_outlets(self) -> None:
        with self._outlets_lock:
            known = {id(outlet.connection): outlet for outlet in self.outlets}
            found: List[Optional[Outlet]] = [
                known.get(id(connection)) or _outlet(connection, connected)
                for connection, connected in connections_of(self)
            ]
            self.outlets = tuple(outlet for outlet in found if outlet is not None)


def _outlet(connection: Any, connected: socket.socket) -> Optional[Outlet]:
    """Limits how long a write to a new subscriber may block, and sends small messages at once.

    Without TCP_NODELAY, which few subscribers ask for, the kernel holds a small message back until the previous one is
    acknowledged, for up to 40 ms: at ten times real time the odometry of a plain node is then half a second old.
    """
    try:
        connected.setsockopt(socket.SOL_SOCKET, socket.SO_SNDTIMEO, struct.pack("ll", STALL_LIMIT, 0))
        connected.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        duplicate = connected.dup()
    except OSError as error:  # mostly because it is being closed
        if error.errno in (errno.EMFILE, errno.ENFILE):
            rospy.logerr("%s is disconnected: %s", connection.endpoint_id, error.strerror)
            with suppress(OSError):
                connected.shutdown(socket.SHUT_RDWR)  # rospy notices that, and forgets it
        return None
    return Outlet(connection, duplicate, duplicate.fileno())


def publisher(
    topic: str, kind: Any, latch: bool = False, on_change: Callable[[], None] = lambda: None
) -> DirectPublisher:
    """Advertise a topic.

    `on_change` is called, from rospy's threads, when a subscriber connects or disconnects.
    """
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", SyntaxWarning)  # rospy advises a queue_size, which would drop messages
        return DirectPublisher(topic, kind, latch, on_change)
