"""The topics on which one robot's measurements are published, each message with the stamp of its step."""

import itertools
from dataclasses import dataclass
from typing import Any, Callable, Dict, Optional

from nav_msgs.msg import Odometry
from sensor_msgs.msg import BatteryState, Imu, JointState, LaserScan, MagneticField
from std_msgs.msg import Bool

from ...component_params import FrameNames, ImuNoise, Rates, TopicParams
from ...robot.model import CAMERA_FRAME
from ...sensors.camera import CameraSpec
from ...sensors.scan_profiles import LidarSpec
from ...simulation import observations as sensor_names
from ...simulation.observations import Observations
from .. import convert
from ..outbox import Outbox
from ..packed import PackedImu, PackedJointState, PackedOdometry, PackedScan, stamp_of
from ..publishing import DirectPublisher, publisher
from .camera_topics import CameraTopics


@dataclass(frozen=True)
class MessageConfig:
    """What the messages of all robots have in common."""

    frames: FrameNames
    topics: TopicParams
    rates: Rates
    lidar: LidarSpec
    imu_noise: ImuNoise


def prefixed(robot: str, name: str) -> str:
    """A topic or frame of a named robot; relative, so that the node's namespace and remappings apply to topics."""
    return f"{robot}/{name}" if robot else name


class RobotTopics:
    """Publishers in a robot's namespace; its frames carry its name as a prefix."""

    def __init__(
        self,
        index: int,
        name: str,
        config: MessageConfig,
        camera: Optional[CameraSpec],
        on_change: Callable[[], None],
    ) -> None:
        """`camera`: None for a model without one.

        `on_change` is called when a subscriber of any topic connects or disconnects.
        """
        self.index = index
        self.name = name
        self.lidar = config.lidar
        self.odom_frame, self.footprint_frame, self.scan_frame, self.imu_frame, camera_frame = (
            prefixed(name, frame)
            for frame in (
                config.frames.odom,
                config.frames.footprint,
                config.frames.scan,
                config.frames.imu,
                CAMERA_FRAME,
            )
        )
        rates, topics = config.rates, config.topics

        def topic(relative: str, kind: Any) -> DirectPublisher:
            return publisher(prefixed(name, relative), kind, on_change=on_change)

        self.scan = topic("scan", LaserScan)
        self.odom = topic("odom", Odometry)
        self.by_sensor: Dict[str, Any] = {
            sensor_names.SCAN: self.scan,
            sensor_names.ODOM: self.odom,
            sensor_names.JOINTS: topic("joint_states", JointState),
            sensor_names.IMU: topic("imu", Imu),
        }
        if topics.ground_truth:
            self.by_sensor[sensor_names.GROUND_TRUTH] = topic("ground_truth_odom", Odometry)
        if rates.bumper:
            self.by_sensor[sensor_names.BUMPER] = topic("bumper", Bool)
        if rates.battery:
            self.by_sensor[sensor_names.BATTERY] = topic("battery_state", BatteryState)
        if rates.magnetic_field:
            self.by_sensor[sensor_names.MAGNETIC_FIELD] = topic("magnetic_field", MagneticField)
        self.camera: Optional[CameraTopics] = None
        if camera is not None and rates.camera:
            self.camera = CameraTopics(prefixed(name, ""), camera, camera_frame, on_change)
            self.by_sensor[sensor_names.CAMERA] = self.camera
        odom_variances = (0.0,) * 6 if topics.real_covariances else convert.ODOM_VARIANCES
        self._odom_message = PackedOdometry(self.odom_frame, self.footprint_frame, convert.diagonal(odom_variances))
        self._truth_message = PackedOdometry(
            config.frames.world, self.footprint_frame, convert.diagonal(convert.TRUTH_VARIANCES)
        )
        covariances = convert.imu_covariances(config.imu_noise, topics.real_covariances)
        self._imu_message = PackedImu(self.imu_frame, covariances)
        self._joints_message = PackedJointState()
        self._scan_messages: Dict[int, PackedScan] = {}  # by the number of beams, which varies with some scanners
        self._scan_numbers = itertools.count(1)

    def publish(self, observed: Observations, outbox: Outbox) -> None:
        """Send this robot's part of one step's observations, what is due often by way of the outbox."""
        robot, topics = self.index, self.by_sensor
        stamp = stamp_of(observed.stamp_ns)
        if robot in observed.ground_truth:
            state = observed.ground_truth[robot]
            message = self._truth_message.update(state.world_from_footprint, state.twist, stamp)
            outbox.put(topics[sensor_names.GROUND_TRUTH], message)
        if robot in observed.imus:
            outbox.put(topics[sensor_names.IMU], self._imu_message.update(observed.imus[robot], stamp))
        if robot in observed.joints:
            outbox.put(topics[sensor_names.JOINTS], self._joints_message.update(observed.joints[robot], stamp))
        if robot in observed.odometry:
            odometry = observed.odometry[robot]
            outbox.put(self.odom, self._odom_message.update(odometry.odom_from_footprint, odometry.twist, stamp))
        if robot in observed.scans:
            ranges = observed.scans[robot]
            outbox.put(self.scan, self._scan_message(len(ranges)).update(ranges, stamp))
        if robot in observed.bumpers:
            topics[sensor_names.BUMPER].publish(observed.bumpers[robot])
        if robot in observed.magnetic_fields:
            field = observed.magnetic_fields[robot]
            time = convert.to_time(observed.stamp_ns)
            topics[sensor_names.MAGNETIC_FIELD].publish(convert.to_magnetic_field(field, time, self.imu_frame))
        if robot in observed.batteries:
            time = convert.to_time(observed.stamp_ns)
            topics[sensor_names.BATTERY].publish(convert.to_battery(time, self.footprint_frame))
        if robot in observed.images and self.camera is not None:
            self.camera.publish(observed.images[robot], convert.to_time(observed.stamp_ns))

    def _scan_message(self, beams: int) -> PackedScan:
        if beams not in self._scan_messages:
            spec = self.lidar if beams == self.lidar.samples else self.lidar.with_samples(beams)
            self._scan_messages[beams] = PackedScan(spec, self.scan_frame, self._scan_numbers)
        return self._scan_messages[beams]
