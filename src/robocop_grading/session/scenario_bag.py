"""A scenario's bag: the messages to and from the submission, and other messages that a replay shows."""

import io
from pathlib import Path
from typing import Any, Dict, Optional, Sequence

import rosbag
import rospy
from visualization_msgs.msg import MarkerArray

from aro_robocop_goto_as.ros import convert
from aro_robocop_goto_as.ros.sim.world_markers import world_markers
from aro_robocop_goto_as.simulation.simulator import Simulator

from ..agent import wire
from ..handout import ACTION
from .step_messages import StepMessage
from .topics import header

MAX_BAG = 32 * 1024**2  # bytes
MARKERS = "/aro_robocop_goto_as_node/markers"  # of this package's server, in the bag only: a replay shows them
# What holds until the next message: a replay that begins later sends the last one before that, by rosbag's own rule.
LASTING = ("/tf_static", "/robocop_sim/world", "/joint_states", f"{ACTION}/goal", MARKERS)


class _NoIndex(Dict[int, Any]):
    """Replaces rosbag's index by time, which only readers use: keeping it sorted is a third of the writing."""

    def __setitem__(self, _connection: int, _entries: Any) -> None:
        pass


class _File(io.BytesIO):
    """A bag in memory until it is closed: rosbag moves about in the file several times for each message."""

    mode = "w+b"  # rosbag asks for it

    def __init__(self, path: Path) -> None:
        super().__init__()
        self._path = path

    def close(self) -> None:
        if not self.closed:
            self._path.write_bytes(self.getvalue())
        super().close()


class ScenarioBag:
    """The bag of the current scenario; only the simulator's owner writes. Without an open bag, messages are dropped."""

    def __init__(self, sim: Simulator, world_frame: str) -> None:
        self._sim, self._world_frame = sim, world_frame
        self._bag: Optional[rosbag.Bag] = None

    def open(self, path: Path) -> None:
        """Begin a bag."""
        self._file = _File(path)
        self._bag = rosbag.Bag(self._file, "w")
        setattr(self._bag, "_connection_indexes", _NoIndex())  # noqa: B010  mypy does not know it

    def close(self) -> None:
        """Write the file of the bag that is open."""
        assert self._bag is not None
        self._bag.close()
        self._bag = None

    def write(self, topic: str, message: Any) -> None:
        """Write a message, unless the bag has become too large."""
        self._write(topic, message, max(convert.to_time(self._sim.stamp_ns), rospy.Time(0, 1)))

    def _write(self, topic: str, message: Any, stamp: rospy.Time, raw: bool = False) -> None:
        if self._bag is not None and self._file.tell() < MAX_BAG:
            self._bag.write(
                topic, message, stamp, raw, header(message, topic=topic, latching="1") if topic in LASTING else None
            )

    def write_scenery(self) -> None:
        """The obstacles of this scenario, and wheels, which the robot's model needs."""
        markers = world_markers(self._sim.world, self._world_frame, self._sim.time)
        self.write("/robocop_sim/world", MarkerArray(markers))
        self.write("/joint_states", convert.to_joint_state((0.0, 0.0), (0.0, 0.0), convert.to_time(self._sim.stamp_ns)))

    def write_step(self, stamp_ns: int, messages: Sequence[StepMessage]) -> None:
        """Write the submission's measurements, and the truth; without messages that a replay does not show."""
        for topic, kind, data in messages:
            if topic not in ("/imu", "/bumper", "/joint_states"):
                raw = kind._type, data[wire.LENGTH.size :], kind._md5sum, kind  # as rosbag.Bag.write() takes it
                self._write(topic, raw, convert.to_time(stamp_ns), raw=True)
