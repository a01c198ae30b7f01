"""Poses and twists in the plane and in space, in the units and axes of REP-103, and constants of physics."""

import math
from dataclasses import dataclass
from typing import NamedTuple, Tuple

import numpy as np

from .param_loading import MAX_COORDINATE as MAX_COORDINATE

STANDARD_GRAVITY = 9.80665  # [m/s^2]
NANOSECONDS = 1000000000  # per second
UPRIGHT = 1e-9  # largest |qx| + |qy| of an orientation without roll and pitch

Vector3 = Tuple[float, float, float]
Quaternion = Tuple[float, float, float, float]  # x, y, z, w, as in geometry_msgs


def wrap_angle(angle: float) -> float:
    """The same angle [rad] within [-pi, pi]; NaN and infinity raise ValueError."""
    return math.remainder(angle, 2.0 * math.pi)


class Pose2D(NamedTuple):
    """Position x, y [m] with heading yaw [rad], counter-clockwise from the x axis.

    A NamedTuple, like Twist2D, because each step creates several poses, and a frozen dataclass takes three times as
    long.
    """

    x: float = 0.0
    y: float = 0.0
    yaw: float = 0.0


class Twist2D(NamedTuple):
    """Velocity of a differential drive in its own frame: v forward [m/s], w counter-clockwise [rad/s]."""

    v: float = 0.0
    w: float = 0.0


STANDSTILL = Twist2D()


def compose(a_from_b: Pose2D, b_from_c: Pose2D) -> Pose2D:
    """Chain two poses: a_from_b and b_from_c give a_from_c."""
    c, s = math.cos(a_from_b.yaw), math.sin(a_from_b.yaw)
    return Pose2D(
        a_from_b.x + c * b_from_c.x - s * b_from_c.y,
        a_from_b.y + s * b_from_c.x + c * b_from_c.y,
        wrap_angle(a_from_b.yaw + b_from_c.yaw),
    )


def inverse(a_from_b: Pose2D) -> Pose2D:
    """The inverse pose: b_from_a."""
    c, s = math.cos(a_from_b.yaw), math.sin(a_from_b.yaw)
    return Pose2D(
        -c * a_from_b.x - s * a_from_b.y,
        s * a_from_b.x - c * a_from_b.y,
        wrap_angle(-a_from_b.yaw),
    )


def quaternion_from_rpy(roll: float, pitch: float, yaw: float) -> Quaternion:
    """The unit quaternion x, y, z, w of fixed-axis roll, pitch, yaw [rad], as in SDF and URDF."""
    cr, sr = math.cos(roll / 2.0), math.sin(roll / 2.0)
    cp, sp = math.cos(pitch / 2.0), math.sin(pitch / 2.0)
    cy, sy = math.cos(yaw / 2.0), math.sin(yaw / 2.0)
    return (
        sr * cp * cy - cr * sp * sy,
        cr * sp * cy + sr * cp * sy,
        cr * cp * sy - sr * sp * cy,
        cr * cp * cy + sr * sp * sy,
    )


def yaw_of(q: Quaternion) -> float:
    """Heading [rad] of a unit quaternion x, y, z, w."""
    x, y, z, w = q
    return math.atan2(2.0 * (w * z + x * y), 1.0 - 2.0 * (y * y + z * z))


def multiply(p: Quaternion, q: Quaternion) -> Quaternion:
    """The rotation q followed by the rotation p."""
    px, py, pz, pw = p
    qx, qy, qz, qw = q
    return (
        pw * qx + px * qw + py * qz - pz * qy,
        pw * qy - px * qz + py * qw + pz * qx,
        pw * qz + px * qy - py * qx + pz * qw,
        pw * qw - px * qx - py * qy - pz * qz,
    )


def rotation_matrix(q: Quaternion) -> np.ndarray:
    """The (3, 3) rotation matrix of a unit quaternion x, y, z, w."""
    x, y, z, w = q
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
            [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
            [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
        ]
    )


@dataclass(frozen=True)
class Pose3D:
    """Position [m] with orientation as a unit quaternion x, y, z, w."""

    position: Vector3 = (0.0, 0.0, 0.0)
    orientation: Quaternion = (0.0, 0.0, 0.0, 1.0)

    @staticmethod
    def from_xyz_rpy(xyz: Vector3, rpy: Vector3) -> "Pose3D":
        """The pose of SDF's and URDF's six numbers: position [m], then roll, pitch, yaw [rad]."""
        return Pose3D(xyz, quaternion_from_rpy(*rpy))

    def is_upright(self) -> bool:
        """Return whether the z axis is vertical: the pose has neither roll nor pitch."""
        return abs(self.orientation[0]) + abs(self.orientation[1]) <= UPRIGHT

    def on_plane(self) -> Pose2D:
        """The pose without height, roll and pitch."""
        return Pose2D(self.position[0], self.position[1], yaw_of(self.orientation))


def compose3(a_from_b: Pose3D, b_from_c: Pose3D) -> Pose3D:
    """Chain two poses in space: a_from_b and b_from_c give a_from_c."""
    x, y, z = rotation_matrix(a_from_b.orientation) @ np.array(b_from_c.position)
    ax, ay, az = a_from_b.position
    return Pose3D(
        (ax + float(x), ay + float(y), az + float(z)),
        multiply(a_from_b.orientation, b_from_c.orientation),
    )


def inverse3(a_from_b: Pose3D) -> Pose3D:
    """The inverse pose in space: b_from_a."""
    x, y, z, w = a_from_b.orientation
    back = (-x, -y, -z, w)
    bx, by, bz = rotation_matrix(back) @ np.array(a_from_b.position)
    return Pose3D((-float(bx), -float(by), -float(bz)), back)


def lifted(pose: Pose2D, z: float = 0.0) -> Pose3D:
    """A planar pose as a level pose in space at height z [m]."""
    return Pose3D((pose.x, pose.y, z), quaternion_from_rpy(0.0, 0.0, pose.yaw))
