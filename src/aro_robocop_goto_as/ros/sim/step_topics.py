"""The topics on which each step is published: all robots' measurements, /tf and /clock."""

from typing import AbstractSet, Callable, Dict, List, Sequence, Tuple

from rosgraph_msgs.msg import Clock

from ...simulation.observations import SCAN, TF, Due, Observations, Subscriptions
from ...simulation.simulator import Simulator
from ..batch import Batch, Posted
from ..packed import packed_clock, packed_transforms
from ..publishing import publisher, push
from ..rospy_internals import set_latched
from .robot_topics import RobotTopics
from .transform_topics import TransformTopics


class StepTopics:
    """What is sent on steps on which the same is due is put together once, until the subscribers change."""

    def __init__(self, simulator: Simulator, hidden: AbstractSet[str] = frozenset()) -> None:
        """`hidden`: sensors that are not published."""
        self._hidden = hidden
        self.transforms = TransformTopics(simulator, self._on_change)
        self.robots = [RobotTopics(index, simulator, self._on_change) for index in range(len(simulator.robots))]
        self._clock = publisher("/clock", Clock, latch=True, on_change=self._on_change)
        self._clock_message = packed_clock()
        set_latched(self._clock, self._clock_message)
        self._changed = True
        self._subscriptions: Subscriptions = {}
        self._batches: Dict[Tuple[Due, int, bool], Tuple[Sequence[Callable[[], None]], Batch]] = {}
        self._clock_alone = Batch([])
        self._sensors_at_ticks = simulator.sensors_at_control_ticks()
        self._kept = False  # whether messages may be kept by the kernel

    def _on_change(self) -> None:
        """A subscriber has connected or disconnected. Called from rospy's threads."""
        self._changed = True

    def subscriptions(self) -> Subscriptions:
        """Sensor -> indices of the robots for which it is subscribed to."""
        if self._changed:
            self._changed = False  # before the look at the connections: a change during it causes another look
            self.count()
            self._batches = {}
            self._clock_alone = Batch([(self._clock, self._clock_message)])
            subscriptions: Dict[str, List[int]] = {}
            for index, robot in enumerate(self.robots):
                for sensor, topic in {**robot.topics, TF: self.transforms.tf}.items():
                    if sensor not in self._hidden and topic.get_num_connections():
                        subscriptions.setdefault(sensor, []).append(index)
            self._subscriptions = subscriptions
        return self._subscriptions

    def publish(self, observed: Observations, clock: bool, on_the_way: bool = False) -> None:
        """All measurements of one step; then the clock, if wanted, so that a tick's data is there when it ticks.

        On the way to a control tick the messages may be kept until the tick's are sent, if the same topics have some
        then, or until push().
        """
        key = observed.due, observed.scans.shape[1], clock
        if key not in self._batches:
            self._batches[key] = self._unpacked(observed.due), self._batch(observed.due, clock)
        unpacked, batch = self._batches[key]
        for publish in unpacked:
            publish()
        more = on_the_way and self._sensors_at_ticks.issuperset(observed.due.sensors)
        if not more and not observed.due.control:  # a control tick's messages take with them what is kept
            self.push()
        self._kept = more
        batch.send(observed.stamp_ns, more)

    def publish_clock(self, stamp_ns: int) -> None:
        """Simulated time [ns] alone."""
        self.subscriptions()
        self._clock_alone.send(stamp_ns)

    def push(self) -> None:
        """Send what is kept until the next control tick, as others are about to see or to change the simulation."""
        if self._kept:
            self._kept = False
            push()

    def count(self) -> None:
        """Update rospy's statistics."""
        for batch in (self._clock_alone, *(batch for _, batch in self._batches.values())):
            batch.count()

    def _unpacked(self, due: Due) -> Sequence[Callable[[], None]]:
        """What publishes the measurements that are not in a batch."""
        of = [
            (self.robots[robot], sensor) for sensor, robots in due.sensors.items() if sensor != TF for robot in robots
        ]
        return [robot.publish[sensor] for robot, sensor in of if sensor in robot.publish and sensor not in self._hidden]

    def _batch(self, due: Due, clock: bool) -> Batch:
        messages: List[Posted] = []
        for sensor, robots in due.sensors.items():
            if sensor == TF:
                transforms = [transform for robot in robots for transform in self.transforms.of(robot)]
                messages += [(self.transforms.tf, packed_transforms(transforms))] if transforms else []
            elif sensor not in self._hidden:
                for robot in map(self.robots.__getitem__, robots):
                    if sensor == SCAN:
                        messages.append((robot.topics[SCAN], robot.scan_message()))
                    elif sensor in robot.packed:
                        messages.append((robot.topics[sensor], robot.packed[sensor]))
        return Batch(messages, [(self._clock, self._clock_message)] if clock else [])
