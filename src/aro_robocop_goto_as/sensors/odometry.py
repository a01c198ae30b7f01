"""Wheel odometry: pose and twist by dead reckoning from wheel angles."""

from typing import NamedTuple

from ..geometry import STANDSTILL, Pose2D, Twist2D, arc, wrap_angle
from ..robot.model import Pair


class Odometry(NamedTuple):
    """Pose of base_footprint in odom, mean twist since the previous update, and the wheel angles at this update."""

    odom_from_footprint: Pose2D
    twist: Twist2D
    wheel_angles: Pair  # left, right [rad], never wrapped


def starting(wheel_angles: Pair) -> Odometry:
    """Odometry at zero, whatever the wheel angles."""
    return Odometry(Pose2D(), STANDSTILL, wheel_angles)


def integrate(before: Odometry, wheel_angles: Pair, dt: float, radius: float, separation: float) -> Odometry:
    """Odometry `dt` [s] later, along the circular arc that the wheels' travel implies; radius and separation in [m]."""
    pose, _, (left_before, right_before) = before
    left, right = (wheel_angles[0] - left_before) * radius, (wheel_angles[1] - right_before) * radius
    distance, turn = (left + right) / 2.0, (right - left) / separation
    dx, dy = arc(pose.yaw, distance, turn)
    after = Pose2D(pose.x + dx, pose.y + dy, wrap_angle(pose.yaw + turn))
    return Odometry(after, Twist2D(distance / dt, turn / dt), wheel_angles)
