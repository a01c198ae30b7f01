"""Names of the nodes at the other end of topics; rospy's public API only counts connections."""

from typing import Any, Set

import rospy


def sender(message: Any) -> str:
    """Name of the node that published a received message."""
    return str(message._connection_header["callerid"])


def publishers_of(subscriber: rospy.Subscriber) -> Set[str]:
    """Names of the nodes that a subscriber is connected to."""
    topic = subscriber.impl  # None: unregistered
    return set() if topic is None else {link.callerid_pub for link in topic.connections}


def is_connected_to(publisher: rospy.Publisher, node: str) -> bool:
    """Return whether a publisher is connected to this node."""
    return bool(publisher.impl.has_connection(node))
