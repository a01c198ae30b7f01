"""The topics on which each step is published: all robots' measurements, transforms and /clock.

Transforms: world -> map -> odom -> base_footprint (REP-105). map -> odom is static, follows ground truth or is left to
others; odom -> base_footprint is sent with each odometry.
"""

from functools import partial
from typing import Callable, Dict, List, Sequence, Tuple

from rosgraph_msgs.msg import Clock
from tf2_msgs.msg import TFMessage

from ...geometry import Pose2D
from ...sensors.camera import CAMERA
from ...sensors.odometry import TF
from ...simulation.observations import Due, Observations, Subscriptions
from ...simulation.simulator import Simulator
from .. import convert
from ..publishing.batch import Batch, Posted
from ..publishing.publisher import DirectPublisher, publisher
from ..publishing.rospy_internals import set_latched
from .sensor_topics import TOPICS, SensorTopics, packed_clock, packed_transforms


class StepTopics:
    """Puts the messages together once for all steps on which the same is due, until the subscribers change."""

    def __init__(self, simulator: Simulator) -> None:
        self._simulator = simulator
        self.tf = publisher("/tf", TFMessage)
        self.tf_static = publisher("/tf_static", TFMessage, latch=True)
        self.robots = [SensorTopics(index, simulator) for index in range(len(simulator.robots))]
        self.clock = publisher("/clock", Clock, latch=True)
        self._clock_message = packed_clock()
        set_latched(self.clock, self._clock_message)
        self._changes = -1  # of the publishers, when these were made:
        self._subscriptions: Subscriptions = {}
        self._batches: Dict[Tuple[Due, int], Tuple[Sequence[Callable[[], None]], Batch]] = {}
        self._clock_alone = Batch([])

    def subscriptions(self) -> Subscriptions:
        """Sensor -> indices of the robots for which it is subscribed to."""
        if self._changes != DirectPublisher.changes:
            self._changes = DirectPublisher.changes  # before the look at the connections: one may change during it
            self._batches = {}
            self._clock_alone = Batch([(self.clock, self._clock_message)])
            subscriptions: Dict[str, List[int]] = {}
            for index, robot in enumerate(self.robots):
                for sensor, topic in {**robot.topics, TF: self.tf}.items():
                    if topic.get_num_connections():
                        subscriptions.setdefault(sensor, []).append(index)
            self._subscriptions = subscriptions
        return self._subscriptions

    def publish(self, observed: Observations, more: bool = False) -> None:
        """All measurements of one step; then the clock if it is due, so that a tick's data is there when it ticks.

        `more`: the next step's messages follow at once.
        """
        due = observed.due
        key = due, observed.scan.ranges.shape[1]
        if key not in self._batches:
            self._batches[key] = self._prepared(due)
        unpacked, batch = self._batches[key]
        for publish in unpacked:
            publish()
        batch.send(observed.stamp_ns, more)

    def publish_static(self) -> None:
        """world -> map, and each robot's map -> odom where that is static."""
        simulator, frames = self._simulator, self._simulator.params.frames
        stamp = convert.to_time(simulator.stamp_ns)
        transforms = [convert.to_transform(frames.world_frame, frames.map_frame, Pose2D(), stamp)]
        if simulator.params.topics.localization == "static":
            transforms += [
                convert.to_transform(frames.map_frame, robot.odom_frame, simulator.map_from_odom(index), stamp)
                for index, robot in enumerate(self.robots)
            ]
        self.tf_static.publish(transforms)

    def publish_clock(self, stamp_ns: int) -> None:
        """Simulated time [ns] alone."""
        self.subscriptions()
        self._clock_alone.send(stamp_ns)

    def packed(self, due: Due) -> List[Posted]:
        """The packed messages of what is due, with their topics."""
        messages: List[Posted] = []
        for sensor in TOPICS:
            for robot in self._due(due, sensor):
                message = robot.packed(sensor)
                messages += [] if message is None else [(robot.topics[sensor], message)]
        transforms = [
            transform for robot in self._due(due, TF) for transform in robot.transforms(self._simulator.params.topics)
        ]
        return [*messages, *([(self.tf, packed_transforms(transforms))] if transforms else [])]

    def _due(self, due: Due, sensor: str) -> List[SensorTopics]:
        return [self.robots[index] for index in due.sensors.get(sensor, ())]

    def _prepared(self, due: Due) -> Tuple[Sequence[Callable[[], None]], Batch]:
        """The functions that publish measurements without a packed message, and the batch of all packed messages."""
        rospys = [sensor for sensor in (*TOPICS, CAMERA) if sensor not in TOPICS or TOPICS[sensor].packed is None]
        unpacked = [partial(robot.publish, sensor) for sensor in rospys for robot in self._due(due, sensor)]
        return unpacked, Batch(self.packed(due), [(self.clock, self._clock_message)] if due.clock else [])
