"""What is received for the page. Callbacks only store; subscriptions exist only while a browser shows the page."""

import time
from collections import deque
from typing import Any, Callable, Deque, List, Optional, Tuple

import rospy
from geometry_msgs.msg import Twist
from nav_msgs.msg import OccupancyGrid
from sensor_msgs.msg import Image, LaserScan
from std_msgs.msg import String
from tf2_msgs.msg import TFMessage
from visualization_msgs.msg import MarkerArray

from aro_robocop_goto_as.msg import (
    GoToPositionActionFeedback,
    GoToPositionActionGoal,
    GoToPositionActionResult,
    SimStatus,
)

from ...web.frames import FrameTree
from ...web.series import Series
from ...web.state import GoalHistory, SimState
from ..action import ACTION
from ..client.goal_handle import STATES
from .marker_shapes import to_pose

SIMULATOR = "/robocop_sim"
SERVER, BRIDGE = "aro_robocop_goto_as_node", "robocop_rviz_goto_ac_node"
CAMERA = "camera/rgb/image_raw"
FEEDBACK_AGE = 1.0  # [s, wall] after which a goal without feedback counts as ended


def absolute(robot: str, name: str) -> str:
    """A robot's topic; "" is the robot without a namespace."""
    return f"/{robot}/{name}" if robot else f"/{name}"


class _Subscriptions:
    """Subscriptions that are opened and closed together."""

    def __init__(self) -> None:
        self._open: List[rospy.Subscriber] = []

    def add(self, topic: str, kind: Any, callback: Callable[[Any], None], queue_size: Optional[int] = 1) -> None:
        self._open.append(rospy.Subscriber(topic, kind, callback, queue_size=queue_size))

    def close(self) -> None:
        for subscription in self._open:
            subscription.unregister()
        self._open = []


class SystemTopics:
    """Transforms, the world, the map and the simulator's report."""

    def __init__(self) -> None:
        self.frames = FrameTree()
        self.markers: Deque[MarkerArray] = deque()
        self.map: Optional[OccupancyGrid] = None
        self.sim: Optional[SimState] = None
        self._subscriptions = _Subscriptions()

    def open(self) -> None:
        """Subscribe."""
        add = self._subscriptions.add
        add("/tf", TFMessage, self._on_tf, queue_size=100)
        add("/tf_static", TFMessage, self._on_tf, queue_size=None)
        add(f"{SIMULATOR}/world", MarkerArray, self.markers.append, queue_size=None)
        add(f"{SIMULATOR}/status", SimStatus, self._on_status)
        add("/map", OccupancyGrid, self._on_map)

    def close(self) -> None:
        """Unsubscribe."""
        self._subscriptions.close()

    def _on_tf(self, message: TFMessage) -> None:
        for stamped in message.transforms:
            transform = stamped.transform
            pose = to_pose(transform.translation, transform.rotation)
            if pose is not None:
                self.frames.update(stamped.header.frame_id.lstrip("/"), stamped.child_frame_id.lstrip("/"), pose)

    def _on_map(self, message: OccupancyGrid) -> None:
        self.map = message

    def _on_status(self, message: SimStatus) -> None:
        self.sim = SimState(
            at=time.monotonic(),
            time=message.stamp.to_sec(),
            world=message.world,
            robots=tuple(message.robots),
            seed=message.seed,
            drive=message.drive,
            sync=message.sync,
            paused=message.paused,
            factor_asked=message.factor_asked,
            factor_reached=message.factor_reached,
        )


class RobotTopics:
    """What the page shows of the selected robot only."""

    def __init__(self, robot: str) -> None:
        self.robot = robot
        self.scan: Optional[LaserScan] = None
        self.image: Optional[Image] = None
        self.bridge = ""
        self.markers: Deque[MarkerArray] = deque()
        self.errors = Series(2)
        self.commands = Series(2)
        self._feedback: Optional[Tuple[float, Tuple[float, float, str]]] = None
        self._subscriptions = _Subscriptions()

    def open(self) -> None:
        """Subscribe."""
        self._add("scan", LaserScan, self._on_scan)
        self._add(CAMERA, Image, self._on_image)
        self._add(f"{SERVER}/markers", MarkerArray, self.markers.append, queue_size=None)
        self._add(f"{BRIDGE}/status", String, self._on_bridge)
        self._add(f"{ACTION}/feedback", GoToPositionActionFeedback, self._on_feedback)
        self._add("cmd_vel", Twist, self._on_command)

    def _add(self, name: str, kind: Any, callback: Callable[[Any], None], queue_size: Optional[int] = 1) -> None:
        self._subscriptions.add(absolute(self.robot, name), kind, callback, queue_size)

    def close(self) -> None:
        """Unsubscribe."""
        self._subscriptions.close()

    def feedback(self, now: float) -> Optional[Tuple[float, float, str]]:
        """The newest feedback, None while no goal is executed."""
        newest = self._feedback
        return newest[1] if newest is not None and now - newest[0] < FEEDBACK_AGE else None

    def _on_scan(self, message: LaserScan) -> None:
        self.scan = message

    def _on_image(self, message: Image) -> None:
        self.image = message

    def _on_bridge(self, message: String) -> None:
        self.bridge = message.data

    def _on_feedback(self, message: GoToPositionActionFeedback) -> None:
        now, feedback = time.monotonic(), message.feedback
        self._feedback = (now, (feedback.position_error, feedback.angle_error, feedback.message))
        self.errors.add(now, feedback.position_error, feedback.angle_error)

    def _on_command(self, message: Twist) -> None:
        self.commands.add(time.monotonic(), message.linear.x, message.angular.z)


class GoalTopics:
    """Goals and results of all robots; always subscribed, as both are rare and the history outlives a page."""

    def __init__(self) -> None:
        self.history = GoalHistory()
        self._robots: Tuple[str, ...] = ()

    def watch(self, robots: Tuple[str, ...]) -> None:
        """Subscribe to the action servers of robots that are new."""
        for robot in robots:
            if robot not in self._robots:
                name = absolute(robot, ACTION)
                rospy.Subscriber(f"{name}/goal", GoToPositionActionGoal, self._on_goal)
                rospy.Subscriber(f"{name}/result", GoToPositionActionResult, self._on_result, robot)
                self._robots = (*self._robots, robot)

    def _on_goal(self, message: GoToPositionActionGoal) -> None:
        position = message.goal.position
        self.history.sent(message.goal_id.id, position.x, position.y)

    def _on_result(self, message: GoToPositionActionResult, robot: str) -> None:
        state = STATES.get(message.status.status, "")
        self.history.ended(robot, message.status.goal_id.id, state, message.result.message)
