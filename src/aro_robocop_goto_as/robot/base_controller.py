"""The base controller of one robot: velocity commands -> limits and command timeout -> wheel speeds.

They are NamedTuples, because they are created in every step and are cheaper than dataclasses.
"""

import math
from typing import NamedTuple, Optional, Tuple

from ..component_params import LimitParams
from ..errors import CommandError
from ..geometry import STANDSTILL, Twist2D
from .model_figures import ModelFigures


class Limits(NamedTuple):
    """What the base controller allows."""

    max_v: float  # [m/s]
    max_w: float  # [rad/s]
    max_dv: float  # [m/s^2]
    max_dw: float  # [rad/s^2]
    timeout: float  # [s] after which a command is no longer in force; 0: never, as in Gazebo


def limits_from(params: LimitParams, figures: ModelFigures) -> Limits:
    """The limits of a model: the parameters' where they are given, else the model's own figures."""
    firmware = params.velocity_limits == "firmware"
    own_v = figures.firmware_linear_velocity if firmware else figures.max_linear_velocity
    own_w = figures.firmware_angular_velocity if firmware else figures.max_angular_velocity
    return Limits(
        _given_or(params.max_linear_velocity, own_v),
        _given_or(params.max_angular_velocity, own_w),
        _given_or(params.max_linear_acceleration, figures.max_linear_acceleration),
        _given_or(params.max_angular_acceleration, figures.max_angular_acceleration),
        _given_or(params.cmd_vel_timeout, figures.cmd_vel_timeout),
    )


def _given_or(given: Optional[float], default: float) -> float:
    return default if given is None else given


class ControllerState(NamedTuple):
    """The command in force, the simulated time [s] at which it arrived, and the velocity reached so far."""

    command: Twist2D = STANDSTILL
    commanded_at: float = 0.0
    velocity: Twist2D = STANDSTILL


STANDING = ControllerState()


def clamp(value: float, limit: float) -> float:
    """The value within [-limit, limit]."""
    return max(-limit, min(limit, value))


def approach(value: float, target: float, step: float) -> float:
    """The value moved towards the target by at most `step`."""
    change = target - value
    return target if abs(change) <= step else value + math.copysign(step, change)


def accept(state: ControllerState, twist: Twist2D, now: float, limits: Limits) -> ControllerState:
    """The state with a new command, clamped to the velocity limits; CommandError for NaN or infinity."""
    if not (math.isfinite(twist.v) and math.isfinite(twist.w)):
        raise CommandError(
            f"velocity command refused: linear.x {twist.v} m/s, angular.z {twist.w} rad/s; expected finite numbers"
        )
    command = Twist2D(clamp(twist.v, limits.max_v), clamp(twist.w, limits.max_w))
    return ControllerState(command, now, state.velocity)


def advance(state: ControllerState, now: float, dt: float, limits: Limits) -> ControllerState:
    """The state one step of `dt` [s] later: brakes after the command timeout, within the acceleration limits."""
    command, commanded_at, velocity = state
    if 0.0 < limits.timeout < now - commanded_at:
        command = STANDSTILL
    if command == velocity:
        return state
    v, w = approach(velocity.v, command.v, limits.max_dv * dt), approach(velocity.w, command.w, limits.max_dw * dt)
    return ControllerState(command, commanded_at, Twist2D(v, w))


def wheel_speeds(velocity: Twist2D, radius: float, separation: float) -> Tuple[float, float]:
    """Left and right wheel speed [rad/s] of an ideal differential drive, radius and separation in [m]."""
    half = velocity.w * (separation / 2.0)
    return (velocity.v - half) / radius, (velocity.v + half) / radius
