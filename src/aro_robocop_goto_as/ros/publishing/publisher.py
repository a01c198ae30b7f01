"""Publishers that wait: each message is written to the subscribers that read before the next step is simulated."""

import errno
import socket
import struct
import threading
import warnings
import weakref
from contextlib import suppress
from typing import Any, List, Optional, Tuple

import rospy

from .rospy_internals import connections_of, send_latched, write_with
from .subscriber_link import SubscriberLink

STALL_TIMEOUT = 2  # [s, wall] without taking any data, after which a subscriber is not waited for any more

_publishers: "weakref.WeakSet[DirectPublisher]" = weakref.WeakSet()


class DirectPublisher(rospy.Publisher):
    """A synchronous publisher: no queue that drops messages, no thread per topic, back-pressure instead of loss."""

    revision = 0  # how often the subscribers of any publisher have changed; counted in rospy's threads
    _lock = threading.Lock()

    def __init__(self, topic: str, kind: Any, latch: bool) -> None:
        self.links: Tuple[SubscriberLink, ...] = ()
        listener = rospy.SubscribeListener()
        listener.peer_subscribe = listener.peer_unsubscribe = lambda *_: self._update_links()
        super().__init__(topic, kind, subscriber_listener=listener, latch=latch, queue_size=None)
        self._update_links()  # for a subscriber that connected before the listener was there
        _publishers.add(self)

    def _update_links(self) -> None:
        with DirectPublisher._lock:
            known = {id(link.connection): link for link in self.links}
            found: List[Optional[SubscriberLink]] = [
                known.get(id(connection)) or _link(connection, connected)
                for connection, connected in connections_of(self)
            ]
            self.links = tuple(link for link in found if link is not None)
            DirectPublisher.revision += 1

    def resume(self) -> None:
        """Send the latched message to subscribers that stood still, missed the message, and read again."""
        for link in self.links:
            if link.stands_still:
                with suppress(OSError):  # the connection is lost: the next message's sender, or rospy, notices it
                    send_latched(self, link.connection, link.push_rest)


def resume() -> None:
    """Serve subscribers that stood still and read again, on topics that are published seldom; batches do so themselves.

    The thread that publishes calls it now and then.
    """
    for topic in list(_publishers):
        topic.resume()


def _link(connection: Any, connected: socket.socket) -> Optional[SubscriberLink]:
    """Limits how long a write to a new subscriber may block, and sends small messages at once.

    Without TCP_NODELAY, which few subscribers ask for, the kernel holds a small message back until the previous one is
    acknowledged, for up to 40 ms: at ten times real time the odometry of a plain node is then half a second old.
    """
    try:
        connected.setsockopt(socket.SOL_SOCKET, socket.SO_SNDTIMEO, struct.pack("ll", STALL_TIMEOUT, 0))
        connected.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        duplicate = connected.dup()
    except OSError as error:  # mostly because it is being closed
        if error.errno in (errno.EMFILE, errno.ENFILE):
            rospy.logerr("%s is disconnected: %s", connection.endpoint_id, error.strerror)
            with suppress(OSError):
                connected.shutdown(socket.SHUT_RDWR)  # rospy notices that, and forgets it
        return None
    link = SubscriberLink(connection, duplicate)
    write_with(connection, weakref.WeakMethod(link.write))
    return link


def publisher(topic: str, kind: Any, latch: bool = False) -> DirectPublisher:
    """Advertise a topic."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", SyntaxWarning)  # rospy advises a queue_size, which would drop messages
        return DirectPublisher(topic, kind, latch)
