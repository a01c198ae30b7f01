"""Publishers that lose nothing: each message is written to its subscribers before the next step is simulated."""

import socket
import struct
import warnings
from contextlib import suppress
from typing import Any

import rospy

STALL_LIMIT = 2  # [s, wall] a subscriber that takes nothing for this long is disconnected, so it can't hang the rest


class _StallGuard(rospy.SubscribeListener):
    """Bounds how long a write to a new subscriber may block, and has nothing held back on its way.

    Without TCP_NODELAY, which few subscribers ask for, the kernel holds a small message back until the one before is
    acknowledged, up to 40 ms: at ten times real time a plain node's odometry then is half a second old.
    """

    def __init__(self) -> None:
        self.publisher: rospy.Publisher | None = None

    def peer_subscribe(self, topic_name: str, topic_publish: Any, peer_publish: Any) -> None:
        """rospy calls this for each new subscriber; a write over the limit fails, and rospy closes the connection."""
        if self.publisher is None:
            return
        for connection in list(self.publisher.impl.connections):
            with suppress(AttributeError, OSError):  # one that is being closed has no socket, or a dead one
                connection.socket.setsockopt(socket.SOL_SOCKET, socket.SO_SNDTIMEO, struct.pack("ll", STALL_LIMIT, 0))
                connection.socket.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)


def publisher(topic: str, kind: Any, latch: bool = False) -> rospy.Publisher:
    """A synchronous publisher: no queue that drops, no thread a topic, and back-pressure instead of loss."""
    guard = _StallGuard()
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", SyntaxWarning)  # rospy's advice to give a queue size; none is what is wanted
        made = rospy.Publisher(topic, kind, subscriber_listener=guard, latch=latch, queue_size=None)
    guard.publisher = made
    return made
