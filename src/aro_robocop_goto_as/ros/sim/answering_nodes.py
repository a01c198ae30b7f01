"""Finds the nodes that answer control ticks and whose subscriptions to this node have all connected.

A node's subscriptions connect one by one and in any order. If lockstep waited for a node whose scan is not connected
yet, the first scans would be lost, and a run that starts at once would depend on how fast the machine is.
"""

import threading
import time
from typing import Callable, Dict, Iterable, Set

import rosgraph
import rospy

from .. import graph
from ..rospy_internals import is_topic_connected_to

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
        self._connected: Dict[str, threading.Event] = {}  # node -> whether all is connected since it came

    def among(self, connected: Iterable[str]) -> Set[str]:
        """Those of the connected nodes that are ready; call it often, and from one thread."""
        nodes = set(connected)
        self._connected = {node: self._connected.get(node) or self._look_at(node) for node in nodes}
        return {node for node, complete in self._connected.items() if complete.is_set()}

    def _look_at(self, node: str) -> threading.Event:
        """An event for a node that has just connected, set once all its subscriptions have; a new one each time."""
        complete = threading.Event()
        thread = threading.Thread(target=self._await, args=(node, complete), name=f"connections of {node}", daemon=True)
        thread.start()
        return complete

    def _await(self, node: str, complete: threading.Event) -> None:
        deadline = time.monotonic() + self._patience
        while not self._is_ready(node) and not rospy.is_shutdown():
            if time.monotonic() >= deadline:
                rospy.logwarn("%s answers ticks, but not all of its subscriptions have connected", node)
                break
            time.sleep(POLL)
        complete.set()
