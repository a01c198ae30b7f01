"""The messages of one step: their bytes go to the node and into the bag."""

from typing import Any, Dict, List, NamedTuple, Tuple

from nav_msgs.msg import Odometry
from rosgraph_msgs.msg import Clock
from std_msgs.msg import Bool

from aro_robocop_goto_as.ros.publishing.batch import Batch
from aro_robocop_goto_as.ros.publishing.packed import PackedMessage
from aro_robocop_goto_as.ros.sim.sensor_topics import NO_VARIANCES, packed_clock, packed_odometry
from aro_robocop_goto_as.ros.sim.step_topics import StepTopics
from aro_robocop_goto_as.sensors.bumper import BUMPER
from aro_robocop_goto_as.sensors.odometry import ODOM
from aro_robocop_goto_as.simulation.observations import Due, Observations
from aro_robocop_goto_as.simulation.simulator import Simulator


class StepMessage(NamedTuple):
    """A message as it is sent, with its length."""

    topic: str
    kind: Any
    data: bytes


class StepMessages:
    """The messages that the simulator publishes for one robot; for the bag also /ground_truth_odom and /clock."""

    def __init__(self, simulator: Simulator, topics: StepTopics) -> None:
        truth, frame = simulator.observed.fleet, simulator.params.frames.world_frame
        footprint = topics.robots[0].footprint_frame
        odometry = packed_odometry(frame, footprint, NO_VARIANCES, truth.poses[0], truth.twists[0])
        self._topics, self._bumper = topics, topics.robots[0].topics[BUMPER].name
        self._truth, self._clock = ("/ground_truth_odom", Odometry, odometry), ("/clock", Clock, packed_clock())
        self._batches: Dict[Due, Tuple[List[Tuple[str, Any, PackedMessage]], Batch]] = {}

    def of(self, seen: Observations) -> List[StepMessage]:
        """The messages that are due on a step, from its observations."""
        due = seen.due
        if due not in self._batches:
            packed = [(topic.name, topic.data_class, message) for topic, message in self._topics.packed(due)]
            packed += [self._truth] if ODOM in due.names else []
            packed += [self._clock] if due.clock else []
            self._batches[due] = packed, Batch([], filled=[message for *_, message in packed])
        packed, batch = self._batches[due]
        batch.send(seen.stamp_ns)
        messages = [StepMessage(topic, kind, message.data.tobytes()) for topic, kind, message in packed]
        if seen.of(BUMPER):
            messages.insert(0, StepMessage(self._bumper, Bool, bytes([1, 0, 0, 0, seen.bumper.touching[0]])))
        return messages
