"""Publishers that lose nothing: each message is written to its subscribers before the next step is simulated."""

import socket
import struct
import warnings
from contextlib import suppress
from typing import Any, Callable, Optional

import rospy

from .packed import PackedMessage
from .private_api import sockets_of, write_message

STALL_LIMIT = 2  # [s, wall] after which a subscriber that accepts no data is disconnected, so that it cannot block us


class _ConnectionListener(rospy.SubscribeListener):
    """Limits how long a write to a new subscriber may block, and sends small messages at once.

    Without TCP_NODELAY, which few subscribers ask for, the kernel holds a small message back until the previous one is
    acknowledged, for up to 40 ms: at ten times real time the odometry of a plain node is then half a second old.
    """

    def __init__(self, on_change: Callable[[], None]) -> None:
        self.publisher: Optional[rospy.Publisher] = None
        self._on_change = on_change

    def peer_subscribe(self, topic_name: str, topic_publish: Any, peer_publish: Any) -> None:
        """rospy calls this for each new subscriber; a write over the limit fails, and rospy closes the connection."""
        if self.publisher is not None:
            for connected in sockets_of(self.publisher):
                with suppress(OSError):  # it is being closed
                    timeout = struct.pack("ll", STALL_LIMIT, 0)
                    connected.setsockopt(socket.SOL_SOCKET, socket.SO_SNDTIMEO, timeout)
                    connected.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        self._on_change()

    def peer_unsubscribe(self, topic_name: str, num_peers: int) -> None:
        """rospy calls this for each subscriber that has disconnected."""
        self._on_change()


def publisher(
    topic: str, kind: Any, latch: bool = False, on_change: Callable[[], None] = lambda: None
) -> rospy.Publisher:
    """A synchronous publisher: no queue that drops messages, no thread per topic, back-pressure instead of loss.

    `on_change` is called, from rospy's threads, when a subscriber connects or disconnects.
    """
    listener = _ConnectionListener(on_change)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", SyntaxWarning)  # rospy advises a queue_size, which would drop messages
        made = rospy.Publisher(topic, kind, subscriber_listener=listener, latch=latch, queue_size=None)
    listener.publisher = made
    return made


def send(topic: rospy.Publisher, message: PackedMessage) -> None:
    """Publish a packed message. It may be updated again when this returns."""
    write_message(topic, message.data)
