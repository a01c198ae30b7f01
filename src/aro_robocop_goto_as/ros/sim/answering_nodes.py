"""Which nodes answer control ticks, each from the moment everything it subscribes to here has connected.

A node's subscriptions connect one by one and in any order. If lockstep waited for a node whose scan is not connected
yet, the first scans would be lost, and a run that starts at once would depend on how fast the machine is.
"""

import threading
import time
from typing import Callable, Iterable, Set

import rosgraph
import rospy

from .. import graph, private_api

POLL = 0.02  # [s, wall] between two looks at a node's connections
PATIENCE = 10.0  # [s, wall] for them; a registration may be left over from a node that was killed


def is_fully_connected(node: str) -> bool:
    """Whether all subscriptions of `node` to topics of this node, as the master knows them, are connected."""
    try:
        topics = graph.topics_between(rospy.get_name(), node)
    except (OSError, rosgraph.MasterException):
        return True  # unknown: the master does not answer
    return all(private_api.is_topic_connected_to(topic, node) for topic in topics)


class AnsweringNodes:
    """Looks at each new node in a thread of its own, as the master may take long to answer."""

    def __init__(self, is_ready: Callable[[str], bool] = is_fully_connected, patience: float = PATIENCE) -> None:
        self._is_ready = is_ready
        self._patience = patience
        self._known: Set[str] = set()  # connected nodes, ready or not
        self._ready: Set[str] = set()

    def among(self, connected: Iterable[str]) -> Set[str]:
        """Those of the connected nodes that are ready; call it often, and from one thread."""
        nodes = set(connected)
        for node in nodes - self._known:
            threading.Thread(target=self._await, args=(node,), name=f"connections of {node}", daemon=True).start()
        self._ready -= self._known - nodes  # those that have disconnected are looked at again when they return
        self._known = nodes
        return nodes & self._ready

    def _await(self, node: str) -> None:
        deadline = time.monotonic() + self._patience
        while not self._is_ready(node) and not rospy.is_shutdown():
            if time.monotonic() >= deadline:
                rospy.logwarn("%s answers ticks, but not all of its subscriptions have connected", node)
                break
            time.sleep(POLL)
        self._ready.add(node)
