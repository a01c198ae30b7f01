"""Finds the nodes that answer control ticks and whose subscriptions to this node have all connected.

A node's subscriptions connect one by one and in any order. If lockstep waited for a node whose scan is not connected
yet, the first scans would be lost, and a run that starts at once would depend on how fast the machine is.
"""

import threading
from typing import Callable, Dict, Iterable, Set

import rosgraph
import rospy

from .. import graph
from ..rospy_internals import is_topic_connected_to
from ..ticker import wait_until

POLL = 0.02  # [s, wall] between two checks of a node's connections
PATIENCE = 10.0  # [s, wall] for them; a registration may be left over from a node that was killed


def is_fully_connected(node: str) -> bool:
    """Whether all subscriptions of `node` to topics of this node, as the master knows them, are connected."""
    try:
        topics = graph.topics_between(rospy.get_name(), node)
    except (OSError, rosgraph.MasterException):
        return True  # unknown: the master does not answer
    return all(is_topic_connected_to(topic, node) for topic in topics)


class AnsweringNodes:
    """Looks at each new node in a thread of its own, as the master may take long to answer."""

    def __init__(self, is_ready: Callable[[str], bool] = is_fully_connected, patience: float = PATIENCE) -> None:
        self._is_ready = is_ready
        self._patience = patience
        self._looks: Dict[str, threading.Thread] = {}  # by node; one ends when all is connected since the node came

    def among(self, connected: Iterable[str]) -> Set[str]:
        """Those of the connected nodes that are ready; call it often, and from one thread."""
        self._looks = {node: self._looks.get(node) or self._look_at(node) for node in {*connected}}
        return {node for node, look in self._looks.items() if not look.is_alive()}

    def _look_at(self, node: str) -> threading.Thread:
        look = threading.Thread(target=self._await, args=(node,), name=f"connections of {node}", daemon=True)
        look.start()
        return look

    def _await(self, node: str) -> None:
        if not (wait_until(lambda: self._is_ready(node), self._patience, POLL) or rospy.is_shutdown()):
            rospy.logwarn("%s answers ticks, but not all of its subscriptions have connected", node)
