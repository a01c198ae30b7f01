"""The topics on which one robot's measurements are published, packed ones stamped by batch.c, others by rospy."""

from typing import Any, Callable, Dict, List, Optional, Tuple

import numpy as np
from nav_msgs.msg import Odometry
from sensor_msgs.msg import Imu, JointState, LaserScan
from std_msgs.msg import Bool

from ...names import prefixed
from ...robot.model import CAMERA_FRAME
from ...simulation.rates import BUMPER, CAMERA, GROUND_TRUTH, IMU, JOINTS, ODOM, SCAN
from ...simulation.simulator import Simulator
from .. import convert
from ..publishing.packed import PackedMessage, counter
from ..publishing.publisher import publisher
from . import sensor_messages as messages


class SensorTopics:
    """Publishers in a robot's namespace; its frames carry its name as a prefix."""

    def __init__(self, index: int, simulator: Simulator, on_change: Callable[[], None]) -> None:
        """`on_change` is called when a subscriber of any topic connects or disconnects."""
        p, observed, truth = simulator.params, simulator.observed, simulator.fleet
        name, odometry, real = simulator.robots[index].name, observed.odometry, p.topics.covariances == "real"
        self._robot, self._simulator = index, simulator
        self.odom_frame = prefixed(name, p.frames.odom_frame)
        self.footprint_frame = prefixed(name, p.frames.base_frame)
        self._scan_frame, self._imu_frame = prefixed(name, p.frames.scan_frame), prefixed(name, p.frames.imu_frame)
        self._scans: Dict[int, PackedMessage] = {}  # by the number of beams, which varies with some scanners
        self._scan_number = counter()
        self.topics: Dict[str, Any] = {}  # by sensor
        for sensor, relative, kind, is_offered in (
            (SCAN, "scan", LaserScan, True),
            (ODOM, "odom", Odometry, True),
            (JOINTS, "joint_states", JointState, True),
            (IMU, "imu", Imu, True),
            (GROUND_TRUTH, "ground_truth_odom", Odometry, p.topics.ground_truth),
            (BUMPER, "bumper", Bool, p.rates.bumper_rate),
        ):
            if is_offered:
                self.topics[sensor] = publisher(prefixed(name, relative), kind, on_change=on_change)
        camera = observed.cameras[index]
        if camera is not None and p.camera.camera_rate:
            from .camera_topics import CameraTopics

            frame = prefixed(name, CAMERA_FRAME)
            self.topics[CAMERA] = CameraTopics(prefixed(name, ""), camera, frame, on_change)
        variances = messages.NO_VARIANCES if real else messages.ODOM_VARIANCES
        poses, twists, footprint = odometry.poses[index], odometry.twists[index], self.footprint_frame
        self._packed = {
            ODOM: messages.packed_odometry(self.odom_frame, footprint, variances, poses, twists),
            JOINTS: messages.packed_joint_state(observed.joint_angles[index], truth.wheel_speeds[index]),
            IMU: messages.packed_imu(self._imu_frame, p.imu, real, observed.imus[index]),
            GROUND_TRUTH: messages.packed_odometry(
                p.frames.world_frame, footprint, messages.TRUTH_VARIANCES, truth.poses[index], truth.twists[index]
            ),
        }

    def packed(self, sensor: str) -> Optional[PackedMessage]:
        """The message of the newest measurement; None if publish() sends it."""
        return self.scan_message() if sensor == SCAN else self._packed.get(sensor)

    def scan_message(self) -> PackedMessage:
        """The message of the newest scan."""
        ranges = self._simulator.observed.scans[self._robot]
        beams = len(ranges)
        if beams not in self._scans:
            spec = self._simulator.lidar.spec
            spec = spec if beams == spec.samples else spec.with_samples(beams)
            self._scans[beams] = messages.packed_scan(spec, self._scan_frame, ranges, self._scan_number)
        return self._scans[beams]

    def publish(self, sensor: str) -> None:
        """Publish the newest measurement of a sensor whose message is not packed."""
        observed, robot, topic = self._simulator.observed, self._robot, self.topics[sensor]
        if sensor == BUMPER:
            topic.publish(observed.bumpers[robot])
        elif robot in observed.images:
            topic.publish(observed.images[robot], convert.to_time(observed.stamp_ns))

    def transforms(self) -> List[Tuple[str, str, np.ndarray]]:
        """Parent, child and parent_from_child (3,): odom -> base; map -> odom if it follows ground truth."""
        p, observed = self._simulator.params, self._simulator.observed
        found = []
        if p.topics.odom_tf:
            found.append((self.odom_frame, self.footprint_frame, observed.odometry.poses[self._robot]))
        if p.topics.localization == "truth":
            found.append((p.frames.map_frame, self.odom_frame, observed.map_from_odom[self._robot]))
        return found
