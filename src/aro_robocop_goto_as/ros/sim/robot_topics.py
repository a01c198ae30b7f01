"""The topics on which one robot's measurements are published, packed ones stamped by sender.c, others by rospy."""

from typing import Any, Callable, Dict

from nav_msgs.msg import Odometry
from sensor_msgs.msg import BatteryState, Imu, JointState, LaserScan, MagneticField
from std_msgs.msg import Bool

from ...robot.model import CAMERA_FRAME
from ...simulation import observations
from ...simulation.simulator import Simulator
from .. import convert
from ..covariances import ODOM_VARIANCES, TRUTH_VARIANCES, diagonal, imu_covariances
from ..names import prefixed
from ..packed import PackedMessage, counter, packed_imu, packed_joint_state, packed_odometry, packed_scan
from ..publishing import publisher


class RobotTopics:
    """Publishers in a robot's namespace; its frames carry its name as a prefix."""

    def __init__(self, index: int, simulator: Simulator, on_change: Callable[[], None]) -> None:
        """`on_change` is called when a subscriber of any topic connects or disconnects."""
        p, observed = simulator.p, simulator.observed
        name = simulator.robots[index].name
        self._robot, self._simulator = index, simulator
        self.odom_frame = prefixed(name, p.frames.odom_frame)
        self.footprint_frame = prefixed(name, p.frames.base_frame)
        self._scan_frame, self._imu_frame = prefixed(name, p.frames.scan_frame), prefixed(name, p.frames.imu_frame)
        self._scans: Dict[int, PackedMessage] = {}  # by the number of beams, which varies with some scanners
        self._scan_number = counter()
        self.topics: Dict[str, Any] = {}  # by sensor
        self.packed: Dict[str, PackedMessage] = {}  # by sensor, as scan_message()
        self.publish: Dict[str, Callable[[], None]] = {}  # by sensor, of those that rospy serializes

        def topic(sensor: str, relative: str, kind: Any) -> None:
            self.topics[sensor] = publisher(prefixed(name, relative), kind, on_change=on_change)

        def odometry(frame: str, variances: Any, rows: Any) -> PackedMessage:
            covariance = diagonal(variances)
            return packed_odometry(frame, self.footprint_frame, covariance, rows.poses[index], rows.twists[index])

        real = p.topics.covariances == "real"
        topic(observations.SCAN, "scan", LaserScan)
        topic(observations.ODOM, "odom", Odometry)
        variances = (0.0,) * 6 if real else ODOM_VARIANCES
        self.packed[observations.ODOM] = odometry(self.odom_frame, variances, observed.odometry)
        topic(observations.JOINTS, "joint_states", JointState)
        angles, speeds = observed.joint_angles[index], observed.fleet.wheel_speeds[index]
        self.packed[observations.JOINTS] = packed_joint_state(angles, speeds)
        topic(observations.IMU, "imu", Imu)
        covariances = imu_covariances(p.imu, real)
        self.packed[observations.IMU] = packed_imu(self._imu_frame, covariances, observed.imus[index])
        if p.topics.ground_truth:
            topic(observations.GROUND_TRUTH, "ground_truth_odom", Odometry)
            truth = odometry(p.frames.world_frame, TRUTH_VARIANCES, observed.fleet)
            self.packed[observations.GROUND_TRUTH] = truth
        if p.rates.bumper_rate:
            topic(observations.BUMPER, "bumper", Bool)
            self.publish[observations.BUMPER] = self._publish_bumper
        if p.rates.battery_state_rate:
            topic(observations.BATTERY, "battery_state", BatteryState)
            self.publish[observations.BATTERY] = self._publish_battery
        if p.rates.magnetic_field_rate:
            topic(observations.MAGNETIC_FIELD, "magnetic_field", MagneticField)
            self.publish[observations.MAGNETIC_FIELD] = self._publish_magnetic_field
        camera = observed.cameras[index]
        if camera is not None and p.rates.camera_rate:
            from .camera_topics import CameraTopics

            frame = prefixed(name, CAMERA_FRAME)
            self.topics[observations.CAMERA] = CameraTopics(prefixed(name, ""), camera, frame, on_change)
            self.publish[observations.CAMERA] = self._publish_image

    def scan_message(self) -> PackedMessage:
        """The message of the newest scan."""
        ranges = self._simulator.observed.scans[self._robot]
        beams = len(ranges)
        if beams not in self._scans:
            spec = self._simulator.lidar.spec
            spec = spec if beams == spec.samples else spec.with_samples(beams)
            self._scans[beams] = packed_scan(spec, self._scan_frame, ranges, self._scan_number)
        return self._scans[beams]

    def _publish_bumper(self) -> None:
        self.topics[observations.BUMPER].publish(self._simulator.observed.bumpers[self._robot])

    def _publish_battery(self) -> None:
        stamp = convert.to_time(self._simulator.stamp_ns)
        self.topics[observations.BATTERY].publish(convert.to_battery(stamp, self.footprint_frame))

    def _publish_magnetic_field(self) -> None:
        field, stamp = self._simulator.observed.magnetic_fields[self._robot], convert.to_time(self._simulator.stamp_ns)
        self.topics[observations.MAGNETIC_FIELD].publish(convert.to_magnetic_field(field, stamp, self._imu_frame))

    def _publish_image(self) -> None:
        images = self._simulator.observed.images
        if self._robot in images:
            self.topics[observations.CAMERA].publish(images[self._robot], convert.to_time(self._simulator.stamp_ns))
