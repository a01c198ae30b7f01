"""The topics on which each step is published: all robots' measurements, transforms and /clock.

Transforms: world -> map -> odom -> base_footprint (REP-105). map -> odom is static, follows ground truth or is left to
others; odom -> base_footprint is sent with each odometry.
"""

from typing import Any, Callable, Dict, Iterator, List, Sequence, Tuple

import genpy
from geometry_msgs.msg import TransformStamped
from rosgraph_msgs.msg import Clock
from tf2_msgs.msg import TFMessage

from ...geometry import Pose2D
from ...names import MAP_FRAME, WORLD_FRAME
from ...robot.model import BASE
from ...sensors.odometry import ODOM
from ...simulation.agenda import StepEvents, Subscriptions
from ...simulation.simulator import Simulator
from .. import convert
from ..publishing.batch import Batch, TopicMessage
from ..publishing.packed import PackedMessage
from ..publishing.publisher import DirectPublisher, publisher
from ..publishing.rospy_internals import set_latched
from .sensor_messages import RobotFrames, Row, packed_transforms, topics_of

MessageMaker = Tuple[DirectPublisher, Callable[[genpy.Time], Any]]  # a topic, and the function that makes its message


def packed_clock() -> PackedMessage:
    """A message on /clock."""
    return PackedMessage(Clock(), {"clock": None})


class StepTopics:
    """Puts the messages together once for all steps on which the same is due, until the subscribers change."""

    def __init__(self, simulator: Simulator) -> None:
        self._simulator, self._params = simulator, simulator.params
        self.robots = [RobotFrames(row, robot.name) for row, robot in enumerate(simulator.robots)]
        self._sensors = [sensor for sensor in simulator.sensors.by_topic.values() if sensor.rate]
        self.tf = publisher("/tf", TFMessage)
        self.tf_static = publisher("/tf_static", TFMessage, latch=True)
        real = self._params.topics.covariances == "real"
        self.topics: Dict[str, List[List[Tuple[DirectPublisher, Any]]]] = {  # by sensor and robot, with their messages
            sensor.topic: [
                [(publisher(name, kind), message) for name, kind, message in topics_of(sensor, robot, real)]
                for robot in self.robots
            ]
            for sensor in self._sensors
        }
        self.clock = publisher("/clock", Clock, latch=True)
        self._clock_message = packed_clock()
        set_latched(self.clock, self._clock_message)
        self._revision = -1  # of the publishers, when these were made:
        self._subscriptions: Subscriptions = {}
        self._prepared: Dict[StepEvents, Tuple[Sequence[MessageMaker], Batch]] = {}
        self._clock_alone = Batch([])

    def subscriptions(self) -> Subscriptions:
        """Topic of a sensor -> indices of the robots for which it is subscribed to; odometry also for /tf."""
        self._follow_subscribers()
        return self._subscriptions

    def _follow_subscribers(self) -> None:
        """Make the batches anew if a subscriber has come or gone."""
        if self._revision != DirectPublisher.revision:
            self._revision = DirectPublisher.revision  # before the look at the connections: one may change during it
            self._prepared = {}
            self._clock_alone = Batch([(self.clock, self._clock_message)])
            subscriptions: Dict[str, List[int]] = {}
            for sensor, of_robots in self.topics.items():
                also = [self.tf] if sensor == ODOM else []
                for row, topics in enumerate(of_robots):
                    if any(topic.get_num_connections() for topic in [*(topic for topic, _ in topics), *also]):
                        subscriptions.setdefault(sensor, []).append(row)
            self._subscriptions = subscriptions

    def publish(self, due: StepEvents, more: bool = False) -> None:
        """All measurements of one step; then the clock if it is due, so that a tick's data is there when it ticks.

        `more`: the next step's messages follow at once.
        """
        if due not in self._prepared:
            self._prepared[due] = self._prepare(due)
        made, batch = self._prepared[due]
        for topic, make in made:
            topic.publish(make(convert.to_time(self._simulator.stamp_ns)))
        batch.send(self._simulator.stamp_ns, more)

    def publish_static(self) -> None:
        """The transforms that change only when a robot is placed."""
        self.tf_static.publish(self.static_transforms())

    def static_transforms(self) -> List[TransformStamped]:
        """world -> map, each robot's map -> odom where that is static, and frames of sensors that no URDF has."""
        simulator = self._simulator
        stamp = convert.to_time(simulator.stamp_ns)
        transforms = [convert.to_transform(WORLD_FRAME, MAP_FRAME, Pose2D(), stamp)]
        for robot in self.robots:
            if self._params.topics.localization == "static":
                map_from_odom = simulator.map_from_odom(robot.row)
                transforms.append(convert.to_transform(robot.map, robot.odom, map_from_odom, stamp))
            transforms += [
                convert.to_transform_3d(robot.of(BASE), robot.of(sensor.frame), sensor.mounts[robot.row], stamp)
                for sensor in self._sensors
                if sensor.frame
            ]
        return transforms

    def publish_clock(self) -> None:
        """Publish simulated time alone."""
        self._follow_subscribers()
        self._clock_alone.send(self._simulator.stamp_ns)

    def messages_due(self, due: StepEvents) -> Iterator[Tuple[DirectPublisher, Any]]:
        """The topics of what is due, with their messages; /tf last, with all robots' transforms in one message."""
        for sensor, of_robots in self.topics.items():
            for row in due.of(sensor):
                yield from of_robots[row]
        transforms = [transform for row in due.of(ODOM) for transform in self.transforms(self.robots[row])]
        if transforms:
            yield self.tf, packed_transforms(transforms)

    def transforms(self, robot: RobotFrames) -> List[Tuple[str, str, Row]]:
        """Parent, child and parent_from_child (3,): odom -> base; map -> odom if it follows ground truth."""
        odometry, topics = self._simulator.sensors.odometry, self._params.topics
        base = (robot.odom, robot.footprint, odometry.poses[robot.row])
        followed = (robot.map, robot.odom, odometry.map_from_odom[robot.row])
        return [base] * topics.odom_tf + [followed] * (topics.localization == "truth")

    def _prepare(self, due: StepEvents) -> Tuple[Sequence[MessageMaker], Batch]:
        """The functions that make messages, and the batch of all packed messages, of topics with subscribers."""
        topics = [(topic, message) for topic, message in self.messages_due(due) if topic.get_num_connections()]
        packed: List[TopicMessage] = [it for it in topics if isinstance(it[1], PackedMessage)]
        made = [it for it in topics if not isinstance(it[1], PackedMessage)]
        return made, Batch(packed, [(self.clock, self._clock_message)] if due.clock else [])
