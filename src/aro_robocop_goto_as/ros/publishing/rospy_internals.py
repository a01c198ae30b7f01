"""The private parts of rospy that publishing uses, each with the reason."""

import contextlib
import socket
import threading
import weakref
from typing import Any, Callable, List, Optional, Tuple

import rospy
from rospy.exceptions import TransportTerminated


def connections_of(publisher: rospy.Publisher) -> List[Tuple[Any, socket.socket]]:
    """A publisher's connections that are open, with their sockets.

    rospy offers no socket options but the subscriber's TCP_NODELAY, and no way to send to several topics at once.
    """
    topic = publisher.impl
    connections = [] if topic is None else topic.connections
    open_ones = [(connection, getattr(connection, "socket", None)) for connection in connections]
    return [(connection, connected) for connection, connected in open_ones if connected is not None]


def disconnect(publisher: rospy.Publisher, connection: Any) -> None:
    """Disconnect a subscriber, unless that has happened already.

    After a connection's own close(), rospy fails to stop watching the socket, because the socket is closed. While a
    duplicate of the socket is open, the system reports the old descriptor's number, and rospy disconnects the next
    subscriber that gets this number.
    """
    topic = publisher.impl
    if topic is not None:
        with topic.c_lock, contextlib.suppress(Exception):  # whatever it is, as rospy
            if connection in topic.connections:
                topic.remove_connection(connection)


def latch_lock(publisher: rospy.Publisher) -> Optional[threading.RLock]:
    """The lock under which rospy sends the message of a latching topic to a new subscriber; None if it doesn't latch.

    Without it, a subscriber could get an older message after a newer one.
    """
    topic = publisher.impl
    return None if topic is None or not topic.is_latch else topic.publock


def set_latched(publisher: rospy.Publisher, message: Any) -> None:
    """Set the message that a latching topic sends to new subscribers: anything with genpy's serialize()."""
    publisher.impl.latch = message


def send_latched(publisher: rospy.Publisher, connection: Any, is_ready: Callable[[], bool]) -> None:
    """Send the message of a latching topic to one subscriber, as rospy does to a new one, if that is ready for it."""
    topic = publisher.impl
    lock = None if topic is None else topic.publock  # None: closed
    if topic is not None and lock is not None:
        with lock:
            if is_ready() and topic.is_latch and topic.latch is not None:
                topic.publish(topic.latch, connection_override=connection)


def write_with(connection: Any, method: "weakref.WeakMethod[Callable[[bytes], None]]") -> None:
    """Have rospy write a connection's messages with a method, which must outlive the connection's use.

    rospy's own method closes the connection of a slow subscriber in the middle of a message.
    """

    def write_data(data: bytes) -> None:
        write = method()
        if write is None:
            raise TransportTerminated("connection closed")
        write(data)

    connection.write_data = write_data
