"""A scenario's bag: what the submission was sent and answered, and what else a replay shows."""

import io
from pathlib import Path
from typing import Any, Dict, Optional

import rosbag
import rospy
from tf2_msgs.msg import TFMessage
from visualization_msgs.msg import MarkerArray

from aro_robocop_goto_as.geometry import Pose2D, Twist2D, compose, inverse
from aro_robocop_goto_as.ros import convert
from aro_robocop_goto_as.ros.sim.sensor_topics import SensorTopics
from aro_robocop_goto_as.ros.sim.world_markers import world_markers
from aro_robocop_goto_as.sim_params import FrameNames
from aro_robocop_goto_as.simulation.observations import ODOM, SCAN, TF, Observations
from aro_robocop_goto_as.simulation.simulator import Simulator

from ..plan import FARTHEST

MOST_BAG = 32 * 1024**2  # bytes
NO_COVARIANCE = [0.0] * 36


class _NoIndex(Dict[int, Any]):
    """In place of rosbag's index by time, which only readers use; keeping it sorted is a third of the writing."""

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
    """Written by the thread that owns the simulator. While none is open, what is written is dropped."""

    def __init__(self, sim: Simulator, robot: SensorTopics, frames: FrameNames) -> None:
        self._sim = sim
        self._robot = robot
        self._frames = frames
        self._bag: Optional[rosbag.Bag] = None

    def open(self, path: Path) -> None:
        """Begin a bag."""
        self.close()
        self._file = _File(path)
        self._bag = rosbag.Bag(self._file, "w")
        setattr(self._bag, "_connection_indexes", _NoIndex())  # noqa: B010  mypy does not know it

    def close(self) -> None:
        """Close the bag, if one is open."""
        if self._bag is not None:
            self._bag.close()
            self._bag = None

    def write(self, topic: str, message: Any, stamp: Optional[rospy.Time] = None) -> None:
        """Write a message, unless the bag has become too large."""
        if self._bag is not None and self._file.tell() < MOST_BAG:
            self._bag.write(topic, message, stamp or max(convert.to_time(self._sim.stamp_ns), rospy.Time(0, 1)))

    def write_static_frames(self, site: Pose2D) -> None:
        """In the bag, map is odom at the scenario's start; in the submission's map that is many metres away."""
        stamp = convert.to_time(self._sim.stamp_ns)
        map_from_odom = compose(inverse(site), self._sim.map_from_odom())
        static = [
            convert.to_transform(self._frames.world_frame, self._frames.map_frame, site, stamp),
            convert.to_transform(self._frames.map_frame, self._robot.odom_frame, map_from_odom, stamp),
        ]
        self.write("/tf_static", TFMessage(static))

    def write_scenery(self, site: Pose2D) -> None:
        """The obstacles of this scenario, and wheels, which the robot's model needs."""
        near = [
            marker
            for marker in world_markers(self._sim.world, self._frames.world_frame, self._sim.time)
            if abs(marker.pose.position.x - site.x) < FARTHEST
        ]
        self.write("/robocop_sim/world", MarkerArray(near))
        self.write("/joint_states", convert.to_joint_state((0.0, 0.0), (0.0, 0.0), convert.to_time(self._sim.stamp_ns)))

    def write_step(self, seen: Observations, stamp: rospy.Time) -> None:
        """Measurements as the submission gets them, and the truth."""
        if self._bag is None:
            return
        odom, footprint = self._robot.odom_frame, self._robot.footprint_frame
        if seen.of(SCAN):
            self.write(
                "/scan", convert.to_scan(seen.scans[0], self._sim.lidar.spec, stamp, self._frames.scan_frame), stamp
            )
        if seen.of(TF):
            self.write("/tf", TFMessage(self._robot.transform_messages(stamp)), stamp)
        if seen.of(ODOM):
            pose, twist = Pose2D(*seen.odometry.poses[0].tolist()), Twist2D(*seen.odometry.twists[0].tolist())
            self.write("/odom", convert.to_odometry(pose, twist, stamp, odom, footprint, NO_COVARIANCE), stamp)
            pose, twist = self._sim.world_from_footprint(), self._sim.velocity()
            truth = convert.to_odometry(pose, twist, stamp, self._frames.world_frame, footprint, NO_COVARIANCE)
            self.write("/ground_truth_odom", truth, stamp)
