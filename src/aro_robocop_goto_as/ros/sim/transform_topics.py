"""The simulator's transforms: world -> map -> odom -> base_footprint (REP-105) on /tf and /tf_static."""

from typing import Callable, Dict, List, Sequence, Tuple

import rospy
from geometry_msgs.msg import TransformStamped
from tf2_msgs.msg import TFMessage

from ...component_params import FrameNames, TopicParams
from ...geometry import Pose2D
from ...simulation.observations import Observations, RobotTransforms
from ...simulation.simulator import Simulator
from .. import convert
from ..outbox import Outbox
from ..packed import PackedTransforms, stamp_of
from ..publishing import publisher
from .robot_topics import prefixed


class TransformTopics:
    """map -> odom is static, follows ground truth or is left to others; odom -> base is sent with each odometry."""

    def __init__(
        self, frames: FrameNames, topics: TopicParams, robots: Sequence[str], on_change: Callable[[], None]
    ) -> None:
        self._frames = frames
        self._topics = topics
        self._odom = [prefixed(robot, frames.odom) for robot in robots]
        self._footprint = [prefixed(robot, frames.footprint) for robot in robots]
        self._packed: Dict[Tuple[int, ...], PackedTransforms] = {}  # by the robots in the message
        self.tf = publisher("/tf", TFMessage, on_change=on_change)
        self.tf_static = publisher("/tf_static", TFMessage, latch=True)

    def publish_static(self, simulator: Simulator) -> Sequence[TransformStamped]:
        """world -> map, and each robot's map -> odom where that is static; returns what was sent."""
        stamp = convert.to_time(simulator.stamp_ns)
        transforms = [convert.to_transform(self._frames.world, self._frames.map, Pose2D(), stamp)]
        if self._topics.localization == "static":
            transforms += [
                convert.to_transform(self._frames.map, odom, simulator.map_from_odom(robot), stamp)
                for robot, odom in enumerate(self._odom)
            ]
        self.tf_static.publish(transforms)
        return transforms

    def publish(self, observed: Observations, outbox: Outbox) -> None:
        """Put the transforms of one step into the outbox."""
        if not observed.transforms:
            return
        robots = tuple(observed.transforms)
        if robots not in self._packed:
            self._packed[robots] = PackedTransforms([pair for robot in robots for pair in self._pairs(robot)])
        poses = [pose for transforms in observed.transforms.values() for pose in self._poses(transforms)]
        if poses:
            outbox.put(self.tf, self._packed[robots].update(poses, stamp_of(observed.stamp_ns)))

    def _pairs(self, robot: int) -> List[Tuple[str, str]]:
        """Parent and child of each transform of a robot: odom -> base; map -> odom if it follows ground truth."""
        odom_tf = [(self._odom[robot], self._footprint[robot])] if self._topics.odom_tf else []
        return odom_tf + ([(self._frames.map, self._odom[robot])] if self._topics.localization == "truth" else [])

    def _poses(self, transforms: RobotTransforms) -> List[Pose2D]:
        """The poses of _pairs."""
        odom_tf = [transforms.odom_from_footprint] if self._topics.odom_tf else []
        return odom_tf + ([transforms.map_from_odom] if self._topics.localization == "truth" else [])

    def messages(self, robot: int, transforms: RobotTransforms, stamp: rospy.Time) -> List[TransformStamped]:
        """One robot's transforms as single messages."""
        return [
            convert.to_transform(parent, child, pose, stamp)
            for (parent, child), pose in zip(self._pairs(robot), self._poses(transforms))
        ]
