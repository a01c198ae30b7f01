"""Publishers that wait: each message is written to the subscribers that read before the next step is simulated.

They skip a subscriber while it stands still. A node may do that for any time, in a debugger or after Ctrl-Z. It gets
the rest of a message when it reads again.
"""

import ctypes
import errno
import select
import socket
import struct
import threading
import warnings
import weakref
from contextlib import suppress
from typing import Any, List, Optional, Tuple

import rospy

from .rospy_internals import connections_of, send_latched, write_with

STALL_TIMEOUT = 2  # [s, wall] without taking any data, after which a subscriber is not waited for any more

_publishers: "weakref.WeakSet[DirectPublisher]" = weakref.WeakSet()


class SubscriberLink:
    """One subscriber of one topic; its publisher's thread calls the methods.

    A subscriber that takes nothing for as long as its socket's send timeout stands still: it misses all messages until
    its socket has room again, and nobody waits for it. Only the rest of one message is kept for it.
    """

    def __init__(self, connection: Any, duplicate: socket.socket) -> None:
        """`duplicate`: of the connection's socket; it stays open even if the connection is closed."""
        self.connection = connection
        self.socket = duplicate
        self.descriptor = duplicate.fileno()
        self._stands = ctypes.c_int64(0)  # read by batch.c
        self._rest = b""
        self._missed = 0  # messages, while it stands still

    @property
    def stands_still(self) -> bool:
        """Return whether it has stopped reading."""
        return bool(self._stands.value)

    @property
    def address(self) -> int:
        """The address of an int64 for C, which is 1 while the subscriber stands still."""
        return ctypes.addressof(self._stands)

    def write(self, data: bytes) -> None:
        """Send a message, or miss it; OSError if the connection is lost."""
        self.finish(memoryview(data), 0, may_wait=True)

    def finish(self, message: memoryview, taken: int, may_wait: bool) -> bool:
        """Send the rest of a message of which `taken` bytes were sent (or -errno); return whether all bytes were sent.

        OSError if the connection is lost. A subscriber that takes nothing at once is skipped, unless this call may
        wait.
        """
        if taken < 0 and taken != -errno.EAGAIN:  # which means that the socket takes nothing at the moment
            raise OSError(-taken, "send")
        left = message[max(0, taken) :]
        if self.push_rest():
            took = self._take(left, socket.MSG_DONTWAIT)
            left, waits = left[took:], took > 0 or (may_wait and not self.stands_still)
            while left and waits:
                took = self._take(left)
                left, waits = left[took:], took > 0
            self._rest = b"" if len(left) == len(message) else bytes(left)
        self._note(not left)
        return not left

    def push_rest(self) -> bool:
        """Send the rest of an earlier message as far as there is room; return whether there is room for another one."""
        if self.stands_still and not self._has_room():
            return False
        if self._rest:
            self._rest = self._rest[self._take(memoryview(self._rest), socket.MSG_DONTWAIT) :]
        return not self._rest

    def _take(self, data: memoryview, flags: int = 0) -> int:
        """The number of bytes that the socket takes; 0 if it takes none now or, without flags, within its timeout."""
        try:
            return self.socket.send(data, flags)
        except BlockingIOError:
            return 0

    def _has_room(self) -> bool:
        """Return whether a third of the socket's buffer is free, or the connection lost.

        The kernel sometimes finds room for one message although nobody reads, but not for that many.
        """
        poll = select.poll()
        poll.register(self.descriptor, select.POLLOUT)
        return bool(poll.poll(0))

    @property
    def _name(self) -> str:
        return f"{self.connection.endpoint_id} ({self.connection.name})"

    def _note(self, sent: bool) -> None:
        """Note, and log, whether it stands still."""
        if sent and self.stands_still:
            rospy.loginfo("%s reads again; it has missed %d messages", self._name, self._missed)
            self._missed = 0
        elif not sent:
            if not self.stands_still:
                rospy.logwarn("%s has stopped reading; it misses all messages until it reads again", self._name)
            self._missed += 1
        self._stands.value = not sent


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
