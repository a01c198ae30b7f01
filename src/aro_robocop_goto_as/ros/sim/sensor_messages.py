"""One robot's sensor -> its topics, with a message each.

A packed message holds its constant bytes, and the places for the numbers of each step: batch.c stamps and sends it.
Other messages are made for each step, and rospy sends them.
"""

from functools import singledispatch
from typing import Any, Callable, List, NamedTuple, Sequence, Tuple, Union

import genpy
import numpy as np
from nav_msgs.msg import Odometry
from sensor_msgs import msg as sensor_msgs
from std_msgs.msg import Bool, Header
from tf2_msgs.msg import TFMessage

from ...geometry import Pose2D
from ...names import FOOTPRINT_FRAME, IMU_FRAME, MAP_FRAME, ODOM_FRAME, SCAN_FRAME, WORLD_FRAME, prefixed
from ...robot.model import CAMERA_FRAME
from ...sensors.bumper import Bumper
from ...sensors.camera import Camera
from ...sensors.ground_truth import GroundTruth
from ...sensors.imu import FORCE, ORIENTATION, RATES, Imu, ImuParams
from ...sensors.lidar import Lidar, LidarProfile
from ...sensors.odometry import JointEncoders, WheelOdometry
from ...sensors.sensor import Sensor
from .. import convert
from ..publishing.packed import PackedMessage, counter

# Variances of x, y, z, roll, pitch, yaw. A huge variance marks what a differential drive cannot measure. The figures
# are those of Gazebo's differential drive plugin, which existing lab code was written against.
ODOM_VARIANCES = (1e-5, 1e-5, 1e12, 1e12, 1e12, 1e-3)
TRUTH_VARIANCES = (1e-12,) * 6
NO_VARIANCES = (0.0,) * 6  # as a real TurtleBot3 sends them
ORIENTATION_VARIANCE = 1e-6  # the simulated IMU's orientation is exact except for rounding
REAL_IMU_VARIANCES = (0.0025, 0.02, 0.04)  # orientation, rates, accelerations of a TurtleBot3's firmware

Row = np.ndarray  # of an array of the simulation, which changes in place


def packed_scan(profile: LidarProfile, frame: str, ranges: Row) -> PackedMessage:
    """The ranges (samples,) [m] of one lidar, with intensities of 0.0, as Gazebo sends them.

    All beams of one scan are taken at once, as Gazebo does: time_increment and scan_time are zero.
    """
    template = sensor_msgs.LaserScan(
        header=Header(frame_id=frame),
        angle_min=profile.angle_min,
        angle_max=profile.angle_max,
        angle_increment=profile.increment,
        range_min=profile.range_min,
        range_max=profile.range_max,
        ranges=ranges.tolist(),
        intensities=[0.0] * len(ranges),
    )
    return PackedMessage(template, {"header": counter(), "ranges": ranges})


def packed_odometry(frame: str, child: str, variances: Tuple[float, ...], pose: Row, twist: Row) -> PackedMessage:
    """Pose (3,) of `child` in `frame` and twist (2,) in `child`, both with these variances (6,)."""
    template = Odometry(header=Header(frame_id=frame), child_frame_id=child)
    template.pose.covariance = template.twist.covariance = convert.diagonal(variances)
    return PackedMessage(template, {"header": counter(), "pose.pose": pose, "twist.twist": twist})


def packed_joint_state(angles: Row, speeds: Row) -> PackedMessage:
    """Wheel angles (2,) [rad] and speeds (2,) [rad/s], left and right."""
    template = convert.to_joint_state((0.0, 0.0), (0.0, 0.0), genpy.Time())
    return PackedMessage(template, {"header": counter(), "position": angles, "velocity": speeds})


def packed_imu(frame: str, noise: ImuParams, real: bool, sample: Row) -> PackedMessage:
    """A sample (10,) of sensors.imu; with the variances of its noise, or those that a real TurtleBot3 reports."""
    variances = (ORIENTATION_VARIANCE, noise.gyro_noise**2, noise.accelerometer_noise**2)
    orientation, rates, force = (convert.diagonal((it,) * 3) for it in (REAL_IMU_VARIANCES if real else variances))
    template = sensor_msgs.Imu(
        header=Header(frame_id=frame),
        orientation_covariance=orientation,
        angular_velocity_covariance=rates,
        linear_acceleration_covariance=force,
    )
    parts = {"orientation": ORIENTATION, "angular_velocity": RATES, "linear_acceleration": FORCE}
    return PackedMessage(template, {"header": counter(), **{name: sample[part] for name, part in parts.items()}})


def packed_transforms(transforms: Sequence[Tuple[str, str, Row]]) -> PackedMessage:
    """One /tf message with transforms: parent, child, and parent_from_child (3,)."""
    template = [convert.to_transform(parent, child, Pose2D(), genpy.Time()) for parent, child, _ in transforms]
    sources = {}
    for index, (_, _, pose) in enumerate(transforms):
        sources.update({f"transforms[{index}].header": None, f"transforms[{index}].transform": pose})
    return PackedMessage(TFMessage(template), sources)


class RobotFrames:
    """One robot's row in the sensors' arrays, and its frames, which carry its name as a prefix."""

    def __init__(self, row: int, name: str) -> None:
        self.row, self._name = row, name
        self.world, self.map = WORLD_FRAME, MAP_FRAME
        self.odom, self.footprint = self.of(ODOM_FRAME), self.of(FOOTPRINT_FRAME)
        self.imu, self.camera = self.of(IMU_FRAME), self.of(CAMERA_FRAME)

    def of(self, name: str) -> str:
        """A frame or topic of this robot."""
        return prefixed(self._name, name)


class SensorTopic(NamedTuple):
    """A topic of one robot's sensor: its message is packed, or made with the stamp of each step."""

    name: str
    kind: Any
    message: Union[PackedMessage, Callable[[genpy.Time], Any]]


@singledispatch
def topics_of(sensor: Sensor, robot: RobotFrames, real: bool) -> List[SensorTopic]:
    """The topics of one robot's sensor; `real`: with the covariances that a TurtleBot3 sends.

    Chosen by the sensor's class, so a sensor that is derived from another one has the other one's message.
    """
    raise NotImplementedError(f"no message for {type(sensor).__name__}")


@topics_of.register
def _(sensor: Bumper, robot: RobotFrames, real: bool) -> List[SensorTopic]:
    return [SensorTopic(robot.of(sensor.topic), Bool, lambda _: Bool(sensor.touching[robot.row]))]


@topics_of.register
def _(sensor: Camera, robot: RobotFrames, real: bool) -> List[SensorTopic]:
    spec = sensor.specs[robot.row]
    if spec is None:
        return []
    from .camera_messages import MESSAGES  # imports ros_numpy

    def making(to_message: Any) -> Callable[[genpy.Time], Any]:
        return lambda stamp: to_message(sensor.images[robot.row], spec, Header(0, stamp, robot.camera))

    return [SensorTopic(robot.of(f"{sensor.topic}/{name}"), kind, making(to)) for name, (kind, to) in MESSAGES.items()]


@topics_of.register
def _(sensor: GroundTruth, robot: RobotFrames, real: bool) -> List[SensorTopic]:
    pose, twist = sensor.poses[robot.row], sensor.twists[robot.row]
    message = packed_odometry(robot.world, robot.footprint, TRUTH_VARIANCES, pose, twist)
    return [SensorTopic(robot.of(sensor.topic), Odometry, message)]


@topics_of.register
def _(sensor: Imu, robot: RobotFrames, real: bool) -> List[SensorTopic]:
    message = packed_imu(robot.imu, sensor.params, real, sensor.samples[robot.row])
    return [SensorTopic(robot.of(sensor.topic), sensor_msgs.Imu, message)]


@topics_of.register
def _(sensor: JointEncoders, robot: RobotFrames, real: bool) -> List[SensorTopic]:
    message = packed_joint_state(sensor.angles[robot.row], sensor.speeds[robot.row])
    return [SensorTopic(robot.of(sensor.topic), sensor_msgs.JointState, message)]


@topics_of.register
def _(sensor: WheelOdometry, robot: RobotFrames, real: bool) -> List[SensorTopic]:
    pose, twist, variances = sensor.poses[robot.row], sensor.twists[robot.row], NO_VARIANCES if real else ODOM_VARIANCES
    message = packed_odometry(robot.odom, robot.footprint, variances, pose, twist)
    return [SensorTopic(robot.of(sensor.topic), Odometry, message)]


@topics_of.register
def _(sensor: Lidar, robot: RobotFrames, real: bool) -> List[SensorTopic]:
    message = packed_scan(sensor.profile, robot.of(sensor.frame or SCAN_FRAME), sensor.ranges[robot.row])
    return [SensorTopic(robot.of(sensor.topic), sensor_msgs.LaserScan, message)]
