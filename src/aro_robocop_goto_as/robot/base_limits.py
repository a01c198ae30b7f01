"""The limits of base controllers; commands are clamped to them here, base_controller.c accelerates within them."""

import math
from typing import NamedTuple, Optional

from ..errors import CommandError
from ..geometry import Twist2D
from ..sim_params import LimitParams
from .model import ModelFigures


class Limits(NamedTuple):
    """Limits of one base controller."""

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


def clamp(value: float, limit: float) -> float:
    """The value within [-limit, limit]."""
    return max(-limit, min(limit, value))


def clamped(twist: Twist2D, limits: Limits) -> Twist2D:
    """A velocity command within the velocity limits; CommandError for NaN or infinity."""
    if not (math.isfinite(twist.v) and math.isfinite(twist.w)):
        raise CommandError(
            f"velocity command refused: linear.x {twist.v} m/s, angular.z {twist.w} rad/s; expected finite numbers"
        )
    return Twist2D(clamp(twist.v, limits.max_v), clamp(twist.w, limits.max_w))
