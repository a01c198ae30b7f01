"""Velocity commands -> limits, time-out -> wheel speeds, for all robots at once."""

import math
from dataclasses import dataclass, replace

import numpy as np

from .errors import CommandError
from .geometry import Twist2D


@dataclass(frozen=True)
class DriveLimits:
    """What the motors' controller allows; time-out 0 holds the last command for ever, as Gazebo does."""

    max_v: float  # [m/s]
    max_w: float  # [rad/s]
    max_dv: float  # [m/s^2]
    max_dw: float  # [rad/s^2]
    timeout: float  # [s]


@dataclass(frozen=True)
class DriveState:
    """Of n robots: the command in force, when it came [s, simulated], and the velocity reached so far.

    Velocities are (n, 2): forward [m/s], counter-clockwise [rad/s].
    """

    command: np.ndarray
    commanded_at: np.ndarray
    velocity: np.ndarray


def standing(robots: int) -> DriveState:
    """All robots stand, with no command."""
    return DriveState(np.zeros((robots, 2)), np.zeros(robots), np.zeros((robots, 2)))


def clamp(value: float, limit: float) -> float:
    """The value within [-limit, limit]."""
    return max(-limit, min(limit, value))


def approach(value: float, target: float, step: float) -> float:
    """The value moved towards the target by `step` at the most."""
    return value + clamp(target - value, step)


def accept(state: DriveState, robot: int, twist: Twist2D, now: float, limits: DriveLimits) -> DriveState:
    """A new command, clamped to the velocity limits; CommandError on NaN or infinity leaves the old one in force."""
    if not (math.isfinite(twist.v) and math.isfinite(twist.w)):
        raise CommandError(
            f"velocity command refused: linear.x {twist.v} m/s, angular.z {twist.w} rad/s; expected finite numbers")
    command, commanded_at = state.command.copy(), state.commanded_at.copy()
    command[robot] = clamp(twist.v, limits.max_v), clamp(twist.w, limits.max_w)
    commanded_at[robot] = now
    return replace(state, command=command, commanded_at=commanded_at)


def stopped(state: DriveState, robot: int) -> DriveState:
    """One robot without command or velocity, as after it was set down."""
    arrays = [state.command.copy(), state.commanded_at, state.velocity.copy()]
    arrays[0][robot] = arrays[2][robot] = 0.0
    return DriveState(*arrays)


def advance(state: DriveState, now: float, dt: float, limits: DriveLimits) -> DriveState:
    """One step of `dt` [s]: brake once the command has timed out, and obey the acceleration limits."""
    command = state.command
    if limits.timeout > 0.0:
        expired = now - state.commanded_at > limits.timeout
        if expired.any() and command[expired].any():
            command = np.where(expired[:, None], 0.0, command)
    change = command - state.velocity
    if command is state.command and not change.any():
        return state
    most = np.array([limits.max_dv * dt, limits.max_dw * dt])
    velocity = np.where(np.abs(change) <= most, command, state.velocity + np.copysign(most, change))
    return DriveState(command, state.commanded_at, velocity)


def wheel_speeds(velocity: np.ndarray, radius: float, separation: float) -> np.ndarray:
    """Left and right wheel speeds (n, 2) [rad/s] of ideal differential drives, radius and separation in [m]."""
    half = velocity[:, 1] * (separation / 2.0)
    return np.stack([velocity[:, 0] - half, velocity[:, 0] + half], axis=1) / radius
