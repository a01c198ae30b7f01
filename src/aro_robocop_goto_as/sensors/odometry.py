"""Wheel angles -> pose and twist, as dead reckoning from encoders gives them, for all robots at once."""

from dataclasses import dataclass

import numpy as np

from ..geometry import wrap_rows


@dataclass(frozen=True)
class Odometry:
    """Of n robots: odom_from_base (n, 3) [m, m, rad] and the mean twist (n, 2) [m/s, rad/s] since the update before."""

    odom_from_base: np.ndarray
    twist: np.ndarray
    wheel_angles: np.ndarray  # (n, 2) left, right [rad], never wrapped


def starting(wheel_angles: np.ndarray) -> Odometry:
    """Odometry at zero, with the wheels (n, 2) [rad] wherever they are."""
    return Odometry(np.zeros((len(wheel_angles), 3)), np.zeros((len(wheel_angles), 2)), wheel_angles)


def integrate(before: Odometry, wheel_angles: np.ndarray, dt: float, radius: float, separation: float) -> Odometry:
    """Odometry `dt` [s] later: exact circular arcs through the wheels' travel, radius and separation in [m]."""
    travel = (wheel_angles - before.wheel_angles) * radius
    distance, turn = (travel[:, 0] + travel[:, 1]) / 2.0, (travel[:, 1] - travel[:, 0]) / separation
    pose = before.odom_from_base
    step = arc(pose[:, 2], distance, turn)
    after = np.stack([pose[:, 0] + step[:, 0], pose[:, 1] + step[:, 1], wrap_rows(pose[:, 2] + turn)], axis=1)
    return Odometry(after, np.stack([distance, turn], axis=1) / dt, wheel_angles)


def arc(yaw: np.ndarray, distance: np.ndarray, turn: np.ndarray) -> np.ndarray:
    """Displacement (n, 2) [m] along circular arcs that start at heading yaw [rad], (n,) each."""
    chord = distance * np.sinc(turn / (2.0 * np.pi))
    heading = yaw + turn / 2.0
    return np.stack([chord * np.cos(heading), chord * np.sin(heading)], axis=1)
