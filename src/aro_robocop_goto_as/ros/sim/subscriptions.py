"""Which sensors of which robots somebody subscribes to, updated when a subscriber connects or disconnects."""

from typing import Any, Dict, List, Mapping, Sequence

from ...simulation.observations import Subscriptions


class SubscriptionTable:
    """Topics by sensor and robot. Any object with `get_num_connections` counts as a topic."""

    def __init__(self) -> None:
        self._topics: List[Mapping[str, Any]] = []  # by robot
        self._changed = True
        self._current: Subscriptions = {}

    def changed(self) -> None:
        """A subscriber has connected or disconnected. Called from rospy's threads."""
        self._changed = True

    def set_topics(self, topics: Sequence[Mapping[str, Any]]) -> None:
        """The topics of each robot, by sensor."""
        self._topics = list(topics)
        self._changed = True

    def current(self) -> Subscriptions:
        """Sensor -> indices of the robots for which it is subscribed to."""
        if self._changed:
            self._changed = False  # before the look at the connections: a change during it causes another look
            subscriptions: Dict[str, List[int]] = {}
            for robot, topics in enumerate(self._topics):
                for sensor, topic in topics.items():
                    if topic.get_num_connections():
                        subscriptions.setdefault(sensor, []).append(robot)
            self._current = subscriptions
        return self._current
