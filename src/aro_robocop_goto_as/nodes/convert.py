"""Core values <-> ROS messages; no decisions."""

import math
from typing import List, Tuple

import numpy as np
import rospy
from genpy import Time
from geometry_msgs.msg import Point, Pose, Quaternion, Transform, TransformStamped, Twist, Vector3
from nav_msgs.msg import Odometry as OdometryMsg
from sensor_msgs.msg import BatteryState, Imu, JointState, LaserScan, MagneticField
from std_msgs.msg import Header

from ..geometry import Pose2D, Pose3D, Twist2D, yaw_of
from ..params import SimParams
from ..robot import WHEEL_JOINTS, Pair
from ..sensors.imu import ImuSample
from ..sensors.scan_profiles import LidarSpec
from ..simtime import NANOSECONDS

# Variances of x, y, z, roll, pitch, yaw; what the drive can't move is marked unknown by a huge one. The figures are
# those of Gazebo's differential drive, which existing lab code was written against.
ODOM_VARIANCES = (1e-5, 1e-5, 1e12, 1e12, 1e12, 1e-3)
TRUTH_VARIANCES = (1e-12,) * 6
ORIENTATION_VARIANCE = 1e-6  # the simulated IMU's orientation is exact but for float rounding
REAL_IMU_VARIANCES = (0.0025, 0.02, 0.04)  # orientation, rates, accelerations, as a TurtleBot3's firmware sends them
FULL_VOLTAGE, DESIGN_CAPACITY = 12.6, 1.8  # [V], [Ah] of a TurtleBot3's battery, three LiPo cells


def to_time(stamp_ns: int) -> Time:
    """Nanoseconds of simulated time as a ROS time."""
    return Time(stamp_ns // NANOSECONDS, stamp_ns % NANOSECONDS)


def to_ns(time: Time) -> int:
    """A ROS time as nanoseconds."""
    return time.secs * NANOSECONDS + time.nsecs


def diagonal(variances: Tuple[float, ...]) -> List[float]:
    """A row-major 6 x 6 or 3 x 3 covariance with these variances and nothing else."""
    size = len(variances)
    return [variances[row] if row == column else 0.0 for row in range(size) for column in range(size)]


def to_quaternion(yaw: float) -> Quaternion:
    """A heading [rad] as a quaternion message."""
    return Quaternion(0.0, 0.0, math.sin(yaw / 2.0), math.cos(yaw / 2.0))


def from_pose_msg(pose: "rospy.AnyMsg") -> Pose2D:
    """geometry_msgs/Pose seen from above."""
    q = pose.orientation
    return Pose2D(pose.position.x, pose.position.y, yaw_of((q.x, q.y, q.z, q.w)))


def from_twist_msg(twist: Twist) -> Twist2D:
    """The two parts of a geometry_msgs/Twist that a differential drive can follow."""
    return Twist2D(twist.linear.x, twist.angular.z)


def to_twist_msg(twist: Twist2D) -> Twist:
    """A velocity as geometry_msgs/Twist."""
    return Twist(Vector3(twist.v, 0.0, 0.0), Vector3(0.0, 0.0, twist.w))


def to_pose_msg(pose: Pose3D) -> Pose:
    """A pose in space as geometry_msgs/Pose."""
    return Pose(Point(*pose.position), Quaternion(*pose.orientation))


def to_transform(parent: str, child: str, parent_from_child: Pose2D, stamp: Time) -> TransformStamped:
    """A pose on the plane as a TF transform."""
    translation = Vector3(parent_from_child.x, parent_from_child.y, 0.0)
    rotation = to_quaternion(parent_from_child.yaw)
    return TransformStamped(Header(0, stamp, parent), child, Transform(translation, rotation))


def to_odometry(pose: Pose2D, twist: Twist2D, stamp: Time, frame: str, child: str,
                covariance: List[float]) -> OdometryMsg:
    """Pose of `child` in `frame` with the twist in `child`; one covariance (36,) serves both."""
    message = OdometryMsg(Header(0, stamp, frame), child, None, None)
    message.pose.pose.position = Point(pose.x, pose.y, 0.0)
    message.pose.pose.orientation = to_quaternion(pose.yaw)
    message.pose.covariance = covariance
    message.twist.twist = to_twist_msg(twist)
    message.twist.covariance = covariance
    return message


def to_scan(ranges: List[float], spec: LidarSpec, stamp: Time, frame: str) -> LaserScan:
    """Ranges as a LaserScan; all beams of one scan are taken at once, as Gazebo does (both time fields zero)."""
    return LaserScan(
        header=Header(0, stamp, frame), angle_min=spec.angle_min, angle_max=spec.angle_max,
        angle_increment=spec.increment, time_increment=0.0, scan_time=0.0,
        range_min=spec.range_min, range_max=spec.range_max, ranges=ranges, intensities=[])


def to_joint_state(angles: Pair, velocities: Pair, stamp: Time) -> JointState:
    """Wheel angles [rad] and speeds [rad/s], left then right."""
    return JointState(Header(0, stamp, ""), list(WHEEL_JOINTS), angles, velocities, [])


def to_imu(sample: ImuSample, stamp: Time, frame: str, params: SimParams) -> Imu:
    """An IMU sample with the covariances of the noise that was put in, or with a real TurtleBot3's."""
    variances = REAL_IMU_VARIANCES if params.covariances == "real" else (
        ORIENTATION_VARIANCE, params.gyro_noise ** 2, params.accelerometer_noise ** 2)
    orientation, rates, accelerations = (diagonal((variance,) * 3) for variance in variances)
    return Imu(
        Header(0, stamp, frame), Quaternion(*sample.orientation), orientation,
        Vector3(*sample.angular_velocity), rates, Vector3(*sample.linear_acceleration), accelerations)


def to_magnetic_field(field: np.ndarray, stamp: Time, frame: str) -> MagneticField:
    """A field (3,) [T]; its covariance is not known, so all zeros."""
    return MagneticField(Header(0, stamp, frame), Vector3(*field.tolist()), diagonal((0.0,) * 3))


def to_battery(stamp: Time, frame: str) -> BatteryState:
    """A TurtleBot3's battery, always full, as nothing drains it; what is not measured is NaN, as the message asks."""
    return BatteryState(
        header=Header(0, stamp, frame), voltage=FULL_VOLTAGE, temperature=math.nan, current=math.nan, charge=math.nan,
        capacity=math.nan, design_capacity=DESIGN_CAPACITY, percentage=1.0, present=True,
        power_supply_status=BatteryState.POWER_SUPPLY_STATUS_DISCHARGING,
        power_supply_health=BatteryState.POWER_SUPPLY_HEALTH_GOOD,
        power_supply_technology=BatteryState.POWER_SUPPLY_TECHNOLOGY_LIPO)
