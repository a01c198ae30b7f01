"""Subscriptions that last for one message each: a node that calls rospy.wait_for_message inside its loop.

Such a node waits for a message of its own at each call, so simulated time has to pass before it can answer a tick. But
none may pass while it subscribes or unsubscribes, or it would miss messages that it gets from a simulator in real time.

The viewer's subscriptions are no part of this: the web page subscribes and unsubscribes as browsers come and go.
"""

from typing import Any, Callable, Dict, List, Sequence

import rospy

from ...ros.private_api import live_connections, messages_sent, subscriber_of
from .display import is_shown


class OneShotSubscriptions:
    """The connections that were made since `forget`, to any of the robot's topics."""

    def __init__(self, topics: Callable[[], Sequence[rospy.Publisher]]) -> None:
        self._topics = topics
        self._lasting: List[Any] = []  # connections
        self._links: Dict[int, Any] = {}  # connections, by their identity
        self.seen = False  # whether the node has ended a subscription since it was started
        self.lasting_seen = False  # whether one that was made while a goal was active has lasted

    def restart(self) -> None:
        """Another node is graded from now on."""
        self.seen = self.lasting_seen = False
        self.forget()

    def forget(self) -> None:
        """Those that exist now are the node's lasting ones."""
        self._lasting = self._live()
        self._links = {}

    def served(self) -> bool:
        """Whether one that has received its message still exists: the node has not returned from its call yet."""
        self._look()
        return any(map(messages_sent, self._links.values()))

    def waiting(self) -> bool:
        """Whether the node waits for a message."""
        self._look()
        return not all(map(messages_sent, self._links.values()))

    def keep_served(self) -> None:
        """Those that have received a message and still exist are lasting ones."""
        for name, connection in list(self._links.items()):
            if messages_sent(connection):
                self._lasting.append(self._links.pop(name))
                self.lasting_seen = True

    def _look(self) -> None:
        live = {id(connection): connection for connection in self._live()}
        self.seen = self.seen or not self._links.keys() <= live.keys()
        for connection in self._lasting:
            live.pop(id(connection), None)
        self._links = live

    def _live(self) -> List[Any]:
        return [
            connection
            for topic in self._topics()
            for connection in live_connections(topic)
            if not is_shown(subscriber_of(connection))
        ]
