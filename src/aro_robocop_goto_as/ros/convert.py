"""Converts between the core's values and ROS messages."""

import math
from typing import List, Sequence, Tuple

from genpy import Time
from geometry_msgs.msg import Point, Pose, Quaternion, Transform, TransformStamped, Twist, Vector3
from sensor_msgs.msg import JointState
from std_msgs.msg import Header

from ..errors import FrameError
from ..geometry import MAX_COORDINATE, NANOSECONDS, Pose2D, Pose3D, Twist2D, yaw_of
from ..robot.model import WHEEL_JOINTS, Pair

# How far a quaternion's length may be from 1. A quarter turn typed as z 0.7 w 0.7 has length 0.99. A larger difference
# is an error of the sender, which normalising would hide. tf2 refuses transforms from 0.005 on.
QUATERNION_TOLERANCE = 0.02


def to_time(stamp_ns: int) -> Time:
    """Nanoseconds of simulated time as a ROS time."""
    return Time(stamp_ns // NANOSECONDS, stamp_ns % NANOSECONDS)


def to_quaternion(yaw: float) -> Quaternion:
    """A heading [rad] as a quaternion message."""
    return Quaternion(0.0, 0.0, math.sin(yaw / 2.0), math.cos(yaw / 2.0))


def from_quaternion(q: Quaternion, unset_is_level: bool = False) -> Tuple[float, float, float, float]:
    """A quaternion from another node, made one of length 1; FrameError where its length is not nearly that.

    `unset_is_level`: all zeros mean no rotation, because the sender of a request or marker left the quaternion out.
    """
    values = (q.x, q.y, q.z, q.w)
    if unset_is_level and not any(values):
        return (0.0, 0.0, 0.0, 1.0)
    length = math.sqrt(sum(value * value for value in values))
    if not abs(length - 1.0) <= QUATERNION_TOLERANCE:  # true for NaN
        raise FrameError(f"expected a quaternion of length 1, got x {q.x} y {q.y} z {q.z} w {q.w}")
    x, y, z, w = (value / length for value in values)
    return x, y, z, w


def require_near(**position: float) -> None:
    """Raise FrameError unless a position is finite and within MAX_COORDINATE."""
    if not all(abs(value) <= MAX_COORDINATE for value in position.values()):  # true for NaN
        got = " ".join(f"{axis} {value}" for axis, value in position.items())
        raise FrameError(f"expected finite numbers within +-{MAX_COORDINATE:g} m, got {got}")


def from_pose_msg(pose: Pose, unset_is_level: bool = False) -> Pose2D:
    """A geometry_msgs/Pose projected onto the plane; FrameError if no robot can be there. See from_quaternion."""
    orientation = from_quaternion(pose.orientation, unset_is_level)
    require_near(x=pose.position.x, y=pose.position.y)
    return Pose2D(pose.position.x, pose.position.y, yaw_of(orientation))


def from_pose_msg_3d(pose: Pose) -> Pose3D:
    """A request's geometry_msgs/Pose in space; FrameError if nothing can be there. See from_quaternion."""
    orientation = from_quaternion(pose.orientation, unset_is_level=True)
    x, y, z = pose.position.x, pose.position.y, pose.position.z
    require_near(x=x, y=y, z=z)
    return Pose3D((x, y, z), orientation)


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


def to_transform_3d(parent: str, child: str, parent_from_child: Pose3D, stamp: Time) -> TransformStamped:
    """A pose in space as a TF transform."""
    translation, rotation = Vector3(*parent_from_child.position), Quaternion(*parent_from_child.orientation)
    return TransformStamped(Header(0, stamp, parent), child, Transform(translation, rotation))


def to_joint_state(angles: Pair, velocities: Pair, stamp: Time) -> JointState:
    """Wheel angles [rad] and speeds [rad/s], left then right."""
    return JointState(Header(0, stamp, ""), list(WHEEL_JOINTS), angles, velocities, [])


def diagonal(variances: Sequence[float]) -> List[float]:
    """A row-major diagonal covariance, 6 x 6 or 3 x 3, with these variances."""
    size = len(variances)
    return [variances[row] if row == column else 0.0 for row in range(size) for column in range(size)]
