"""Definitions of what the compiled fleet computes, one robot and one step at a time, without its short cuts."""

import math
from typing import Sequence, Tuple

import numpy as np

from aro_robocop_goto_as.geometry import Pose2D

MARGIN = 1e-6  # [m] kept free in front of whatever blocks a disc


def controlled(velocity: np.ndarray, command: np.ndarray, age: float, limits: np.ndarray, dt: float) -> np.ndarray:
    """Velocity (2,) of a base controller after a step of dt [s]; `age` [s] of the command, limits as in Limits."""
    timeout, change = limits[4], limits[2:4] * dt
    target = command if timeout == 0.0 or age <= timeout else np.zeros(2)
    return velocity + np.clip(target - velocity, -change, change)


def wheel_speeds(velocity: np.ndarray, radius: float, separation: float) -> np.ndarray:
    """Left and right wheel speed (2,) [rad/s] at v [m/s], w [rad/s]."""
    return (velocity[0] + velocity[1] * separation * np.array([-0.5, 0.5])) / radius


def rolled(left: float, right: float, separation: float) -> Tuple[float, float]:
    """The length [m] and the turn [rad] of the arc along which two wheels have rolled [m]."""
    return (left + right) / 2.0, (right - left) / separation


def after_arc(pose: Pose2D, length: float, turn: float) -> Pose2D:
    """The pose after an arc, by its centre."""
    x, y, yaw = pose
    if abs(turn) < 1e-6:
        return Pose2D(x + length * math.cos(yaw + turn / 2.0), y + length * math.sin(yaw + turn / 2.0), yaw + turn)
    radius, end = length / turn, yaw + turn
    return Pose2D(x + radius * (math.sin(end) - math.sin(yaw)), y - radius * (math.cos(end) - math.cos(yaw)), end)


class ReferenceOdometry:
    """Wheel odometry of one robot."""

    def __init__(self, radius: float, separation: float, slip: float = 0.0, tick: float = 0.0) -> None:
        self.radius, self.separation, self.slip, self.tick = radius, separation, slip, tick
        self.pose, self.twist = Pose2D(), (0.0, 0.0)
        self._true, self._counted, self._read = np.zeros(2), np.zeros(2), np.zeros(2)

    def update(self, angles: np.ndarray, noise: np.ndarray, dt: float) -> None:
        """At true wheel angles (2,) [rad], dt [s] after the update before; noise (2,) standard normal."""
        angles = angles.copy()
        counted = self._counted + (angles - self._true) * (1.0 + self.slip * np.abs(noise)) if self.slip else angles
        read = np.floor(counted / self.tick) * self.tick if self.tick else counted
        length, turn = rolled(*((read - self._read) * self.radius), self.separation)
        self.pose, self.twist = after_arc(self.pose, length, turn), (length / dt, turn / dt)
        self._true, self._counted, self._read = angles, counted, read


def free_part(
    start: np.ndarray, move: np.ndarray, radius: float, segments: np.ndarray, circles: np.ndarray, margin: float = 0.0
) -> float:
    """The fraction of a disc's displacement (2,) [m] until it meets a segment (m, 2, 2) or enters a circle (k, 3).

    It may leave a circle freely, and keeps MARGIN in front of what it meets; `margin` [m] is added to all radii.
    """
    radius += margin
    ends = np.column_stack([segments.reshape(-1, 2), np.full(2 * len(segments), radius)])
    inflated = np.concatenate([circles + [0.0, 0.0, radius], ends])
    fraction = min(_to_circles(start, move, inflated), _to_sides(start, move, segments, radius))
    return max(0.0, fraction - MARGIN / math.hypot(*move)) if fraction < 1.0 else 1.0


def _to_circles(start: np.ndarray, move: np.ndarray, circles: np.ndarray) -> float:
    offset = circles[:, :2] - start
    towards, squared = offset @ move, float(move @ move)
    root = towards**2 - squared * ((offset**2).sum(axis=1) - circles[:, 2] ** 2)
    met = (root > 0.0) & (towards > 0.0)
    return float(np.maximum((towards[met] - np.sqrt(root[met])) / squared, 0.0).min(initial=1.0))


def _to_sides(start: np.ndarray, move: np.ndarray, segments: np.ndarray, radius: float) -> float:
    along = segments[:, 1] - segments[:, 0]
    lengths = np.hypot(*along.T)
    along = along / lengths[:, None]
    normals = np.column_stack([-along[:, 1], along[:, 0]])
    away = ((start - segments[:, 0]) * normals).sum(axis=1)
    approach = -(normals @ move) * np.where(away >= 0.0, 1.0, -1.0)
    near = approach > np.maximum(np.abs(away) - radius, 0.0)
    fractions = np.maximum(np.abs(away[near]) - radius, 0.0) / approach[near]
    places = ((start + fractions[:, None] * move - segments[near, 0]) * along[near]).sum(axis=1)
    return float(fractions[(places >= 0.0) & (places <= lengths[near])].min(initial=1.0))


def others(poses: np.ndarray, radii: Sequence[float], robot: int) -> np.ndarray:
    """All robots but one as circles (n - 1, 3) [m]."""
    return np.delete(np.column_stack([poses[:, :2], radii]), robot, axis=0)
