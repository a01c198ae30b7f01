"""Velocity commands -> limits, time-out -> wheel speeds, of one robot."""

import math
from typing import NamedTuple, Tuple

from .errors import CommandError
from .geometry import STANDSTILL, Twist2D
from .params import ModelFigures, SimParams


class DriveLimits(NamedTuple):
    """What the motors' controller allows; time-out 0 holds the last command for ever, as Gazebo does."""

    max_v: float  # [m/s]
    max_w: float  # [rad/s]
    max_dv: float  # [m/s^2]
    max_dw: float  # [rad/s^2]
    timeout: float  # [s]


def limits_from(p: SimParams, own: ModelFigures) -> DriveLimits:
    """What the parameters ask for; where they are 0, of the time-out -1, the model's own."""
    v, w = ((own.firmware_linear_velocity, own.firmware_angular_velocity) if p.velocity_limits == "firmware"
            else (own.max_linear_velocity, own.max_angular_velocity))
    return DriveLimits(
        p.max_linear_velocity or v, p.max_angular_velocity or w,
        p.max_linear_acceleration or own.max_linear_acceleration,
        p.max_angular_acceleration or own.max_angular_acceleration,
        own.cmd_vel_timeout if p.cmd_vel_timeout < 0.0 else p.cmd_vel_timeout)


class DriveState(NamedTuple):
    """The command in force, when it came [s, simulated], and the velocity reached so far."""

    command: Twist2D = STANDSTILL
    commanded_at: float = 0.0
    velocity: Twist2D = STANDSTILL


STANDING = DriveState()


def clamp(value: float, limit: float) -> float:
    """The value within [-limit, limit]."""
    return max(-limit, min(limit, value))


def approach(value: float, target: float, step: float) -> float:
    """The value moved towards the target by `step` at the most."""
    change = target - value
    return target if abs(change) <= step else value + math.copysign(step, change)


def accept(state: DriveState, twist: Twist2D, now: float, limits: DriveLimits) -> DriveState:
    """A new command, clamped to the velocity limits; CommandError on NaN or infinity leaves the old one in force."""
    if not (math.isfinite(twist.v) and math.isfinite(twist.w)):
        raise CommandError(
            f"velocity command refused: linear.x {twist.v} m/s, angular.z {twist.w} rad/s; expected finite numbers")
    command = Twist2D(clamp(twist.v, limits.max_v), clamp(twist.w, limits.max_w))
    return DriveState(command, now, state.velocity)


def advance(state: DriveState, now: float, dt: float, limits: DriveLimits) -> DriveState:
    """One step of `dt` [s]: brake once the command has timed out, and obey the acceleration limits."""
    command, commanded_at, velocity = state
    if 0.0 < limits.timeout < now - commanded_at:
        command = STANDSTILL
    if command == velocity:
        return state
    v, w = approach(velocity.v, command.v, limits.max_dv * dt), approach(velocity.w, command.w, limits.max_dw * dt)
    return DriveState(command, commanded_at, Twist2D(v, w))


def wheel_speeds(velocity: Twist2D, radius: float, separation: float) -> Tuple[float, float]:
    """Left and right wheel speed [rad/s] of an ideal differential drive, radius and separation in [m]."""
    half = velocity.w * (separation / 2.0)
    return (velocity.v - half) / radius, (velocity.v + half) / radius
