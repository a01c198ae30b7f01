"""The base of the parts of the page. Each part has its topics, its elements of the panel and its shapes."""

import time
from collections import deque
from dataclasses import dataclass
from typing import Any, Callable, Deque, List, Optional, Tuple

import rospy

from ...geometry import Pose3D, compose3
from ...web import text
from ...web.scene import PageScene
from ...web.state import PageState, SharedState
from .frames import LATEST, Frames
from .requests import Requests

Handler = Callable[[float, Any], None]  # time at which a message was received [s, monotonic], the message


@dataclass(frozen=True)
class Context:
    """What the parts of a page share."""

    server: Any  # of viser
    scene: PageScene
    state: SharedState
    requests: Requests
    frames: Frames
    fixed_frame: str  # that the scene is drawn in where it is known

    def locate(self, frame: str, stamp: rospy.Time = LATEST) -> Optional[Pose3D]:
        """The pose of a frame in the frame of the scene, the newest or that at a stamp; None if it is not known yet."""
        return self.frames.lookup(self.state.now.root, frame.lstrip("/"), stamp)

    def place(self, robot: str, x: float, y: float) -> str:
        """A position in a robot's odom [m] in words: in the fixed frame, otherwise in odom, and the text says so."""
        odom = self.frame_of(robot, "odom")
        fixed_from_odom = self.frames.lookup(self.fixed_frame, odom)
        if fixed_from_odom is None:
            return f"{text.position(x, y)} in {odom}"
        x, y, _ = compose3(fixed_from_odom, Pose3D((x, y, 0.0))).position
        return text.position(x, y)

    def frame_of(self, robot: str, link: str) -> str:
        """A link's frame, which has the robot's name as a prefix if there are several robots."""
        prefixed = f"{robot}/{link}"
        return prefixed if robot and self.frames.knows(prefixed) else link


class Inbox:
    """Subscriptions that are closed together; the node's main thread handles their messages, by `deliver`."""

    def __init__(self) -> None:
        self._subscriptions: List[Tuple[rospy.Subscriber, Deque[Tuple[float, Any]], Handler]] = []

    def subscribe(self, topic: str, kind: Any, handler: Handler, keep: Optional[int] = 1) -> rospy.Subscriber:
        """Subscribe, and keep the last `keep` messages waiting, or all messages."""
        waiting: Deque[Tuple[float, Any]] = deque(maxlen=keep)
        subscriber = rospy.Subscriber(
            topic, kind, lambda message: waiting.append((time.monotonic(), message)), queue_size=keep
        )
        self._subscriptions.append((subscriber, waiting, handler))
        return subscriber

    def deliver(self) -> None:
        """Handle all waiting messages, each topic's in the order of arrival."""
        for _, waiting, handler in self._subscriptions:
            while waiting:  # rospy's threads only add messages
                handler(*waiting.popleft())

    def close(self) -> None:
        """Unsubscribe."""
        for subscriber, _, _ in self._subscriptions:
            subscriber.unregister()
        self._subscriptions = []


class Part:
    """A part of the page; everything but callbacks of viser runs in the node's main thread."""

    def __init__(self, context: Context) -> None:
        self.context = context

    def subscribe(self, inbox: Inbox) -> None:
        """Subscribe to topics of the system; called when the first browser opens the page."""

    def subscribe_to_robot(self, inbox: Inbox, robot: str) -> None:
        """Forget the previous robot, and subscribe to the topics of the newly selected robot."""

    def ask_master(self, state: PageState) -> None:
        """Ask the ROS master as needed; called once a second."""

    def show(self, state: PageState) -> None:
        """Show the received messages in panel and scene."""
