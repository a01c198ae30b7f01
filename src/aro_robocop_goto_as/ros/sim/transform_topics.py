"""The simulator's transforms: world -> map -> odom -> base_footprint (REP-105) on /tf and /tf_static."""

from typing import Callable, List, Sequence, Tuple

import numpy as np
import rospy
from geometry_msgs.msg import TransformStamped
from tf2_msgs.msg import TFMessage

from ...geometry import Pose2D
from ...simulation.simulator import Simulator
from .. import convert
from ..names import prefixed
from ..publishing import publisher


class TransformTopics:
    """map -> odom is static, follows ground truth or is left to others; odom -> base is sent with each odometry."""

    def __init__(self, simulator: Simulator, on_change: Callable[[], None]) -> None:
        """`on_change` is called when a subscriber of /tf connects or disconnects."""
        self._simulator = simulator
        self._frames, self._topics = simulator.p.frames, simulator.p.topics
        self._odom = [prefixed(robot.name, self._frames.odom_frame) for robot in simulator.robots]
        self._footprint = [prefixed(robot.name, self._frames.base_frame) for robot in simulator.robots]
        self.tf = publisher("/tf", TFMessage, on_change=on_change)
        self.tf_static = publisher("/tf_static", TFMessage, latch=True)

    def publish_static(self) -> Sequence[TransformStamped]:
        """world -> map, and each robot's map -> odom where that is static; returns what was sent."""
        simulator = self._simulator
        stamp = convert.to_time(simulator.stamp_ns)
        transforms = [convert.to_transform(self._frames.world_frame, self._frames.map_frame, Pose2D(), stamp)]
        if self._topics.localization == "static":
            transforms += [
                convert.to_transform(self._frames.map_frame, odom, simulator.map_from_odom(robot), stamp)
                for robot, odom in enumerate(self._odom)
            ]
        self.tf_static.publish(transforms)
        return transforms

    def of(self, robot: int) -> List[Tuple[str, str, np.ndarray]]:
        """Parent, child and parent_from_child (3,): odom -> base; map -> odom if it follows ground truth."""
        observed, odom, footprint = self._simulator.observed, self._odom[robot], self._footprint[robot]
        found = [(odom, footprint, observed.odometry.poses[robot])] if self._topics.odom_tf else []
        if self._topics.localization == "truth":
            found.append((self._frames.map_frame, odom, observed.map_from_odom[robot]))
        return found

    def messages(self, robot: int, stamp: rospy.Time) -> List[TransformStamped]:
        """One robot's transforms as single messages."""
        return [
            convert.to_transform(parent, child, Pose2D(*pose.tolist()), stamp) for parent, child, pose in self.of(robot)
        ]
