"""The messages of one step: their bytes go to the node and into the bag."""

from typing import Any, Dict, List, Tuple

from nav_msgs.msg import Odometry
from rosgraph_msgs.msg import Clock

from aro_robocop_goto_as.ros import convert
from aro_robocop_goto_as.ros.publishing.batch import Batch
from aro_robocop_goto_as.ros.publishing.packed import PackedMessage
from aro_robocop_goto_as.ros.sim.sensor_messages import NO_VARIANCES, packed_odometry
from aro_robocop_goto_as.ros.sim.step_topics import StepTopics, packed_clock
from aro_robocop_goto_as.sensors.odometry import ODOM
from aro_robocop_goto_as.simulation.agenda import StepEvents
from aro_robocop_goto_as.simulation.simulator import Simulator

StepMessage = Tuple[str, Any, bytes]  # topic, type, and the message as it is sent, with its length


class StepMessages:
    """The messages that the simulator publishes for one robot; for the bag also /ground_truth_odom and /clock."""

    def __init__(self, simulator: Simulator, topics: StepTopics) -> None:
        truth, robot = simulator.sensors.ground_truth, topics.robots[0]
        odometry = packed_odometry(robot.world, robot.footprint, NO_VARIANCES, truth.poses[0], truth.twists[0])
        self._simulator, self._topics = simulator, topics
        self._truth, self._clock = ("/ground_truth_odom", Odometry, odometry), ("/clock", Clock, packed_clock())
        self._prepared: Dict[StepEvents, Tuple[List[Tuple[str, Any, Any]], Batch]] = {}

    def of(self, due: StepEvents) -> List[StepMessage]:
        """The messages that are due on the simulator's present step."""
        if due not in self._prepared:
            messages = [(topic.name, topic.data_class, message) for topic, message in self._topics.messages_due(due)]
            messages += [self._truth] if due.of(ODOM) else []
            messages += [self._clock] if due.clock else []
            packed = [message for *_, message in messages if isinstance(message, PackedMessage)]
            self._prepared[due] = messages, Batch([], filled=packed)
        messages, batch = self._prepared[due]
        batch.send(self._simulator.stamp_ns)
        return [(topic, kind, self._bytes_of(message)) for topic, kind, message in messages]

    def _bytes_of(self, message: Any) -> bytes:
        if not isinstance(message, PackedMessage):
            message = PackedMessage(message(convert.to_time(self._simulator.stamp_ns)))
        return bytes(message.data.tobytes())
