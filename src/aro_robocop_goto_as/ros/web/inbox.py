"""Topics of the page: subscriptions whose messages are handled by the node's main thread."""

import time
from collections import deque
from typing import Any, Callable, Deque, List, Optional, Tuple

import rospy

Handler = Callable[[float, Any], None]  # time at which a message was received [s, monotonic], the message


class Inbox:
    """Subscriptions that are closed together. Messages wait until `deliver` passes them to their handlers."""

    def __init__(self) -> None:
        self._subscriptions: List[Tuple[rospy.Subscriber, Deque[Tuple[float, Any]], Handler]] = []

    def subscribe(self, topic: str, kind: Any, handler: Handler, keep: Optional[int] = 1) -> None:
        """Subscribe, and let the last `keep` messages wait, or all."""
        waiting: Deque[Tuple[float, Any]] = deque(maxlen=keep)
        subscriber = rospy.Subscriber(
            topic, kind, lambda message: waiting.append((time.monotonic(), message)), queue_size=keep
        )
        self._subscriptions.append((subscriber, waiting, handler))

    def deliver(self) -> None:
        """Handle all messages that wait; those of one topic in the order of their arrival."""
        for _, waiting, handler in self._subscriptions:
            while waiting:
                handler(*waiting.popleft())

    def clear(self) -> None:
        """Forget the messages that wait."""
        for _, waiting, _ in self._subscriptions:
            waiting.clear()

    def close(self) -> None:
        """Unsubscribe."""
        for subscriber, _, _ in self._subscriptions:
            subscriber.unregister()
        self._subscriptions = []
