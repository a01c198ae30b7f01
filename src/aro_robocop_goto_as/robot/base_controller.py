"""Base controllers: commands are clamped to their limits here, base_controller.c accelerates within them."""

import math
from dataclasses import dataclass
from typing import NamedTuple, Optional

from ..errors import CommandError
from ..geometry import Twist2D
from ..param_loading import MODELS_OWN, parameter, positive
from .model import ModelFigures


@dataclass(frozen=True)
class LimitParams:
    """Limits of every robot's base controller."""

    velocity_limits: str = parameter(
        "teleop", choices=("teleop", "firmware"), about="which of the model's own velocity limits hold"
    )
    max_linear_velocity: Optional[float] = positive(None, "[m/s]", otherwise=MODELS_OWN)
    max_angular_velocity: Optional[float] = positive(None, "[rad/s]", otherwise=MODELS_OWN)
    max_linear_acceleration: Optional[float] = positive(None, "[m/s^2]", otherwise=MODELS_OWN)
    max_angular_acceleration: Optional[float] = positive(None, "[rad/s^2]", otherwise=MODELS_OWN)
    cmd_vel_timeout: Optional[float] = parameter(
        None, low=0.0, about="[s] without a command until the robot brakes; 0 = never", otherwise=MODELS_OWN
    )


class BaseLimits(NamedTuple):
    """Limits of one base controller."""

    max_v: float  # [m/s]
    max_w: float  # [rad/s]
    max_dv: float  # [m/s^2]
    max_dw: float  # [rad/s^2]
    timeout: float  # [s] after which a command is no longer in force; 0: never, as in Gazebo


def limits_from(params: LimitParams, figures: ModelFigures) -> BaseLimits:
    """The limits of a model: the parameters' where they are given, else the model's own figures."""
    firmware = params.velocity_limits == "firmware"
    pairs = (
        (params.max_linear_velocity, figures.firmware_linear_velocity if firmware else figures.max_linear_velocity),
        (params.max_angular_velocity, figures.firmware_angular_velocity if firmware else figures.max_angular_velocity),
        (params.max_linear_acceleration, figures.max_linear_acceleration),
        (params.max_angular_acceleration, figures.max_angular_acceleration),
        (params.cmd_vel_timeout, figures.cmd_vel_timeout),
    )
    return BaseLimits(*(own if given is None else given for given, own in pairs))


def require_finite(twist: Twist2D) -> None:
    """CommandError if a velocity command is NaN or infinite."""
    if not (math.isfinite(twist.v) and math.isfinite(twist.w)):
        raise CommandError(
            f"velocity command refused: linear.x {twist.v} m/s, angular.z {twist.w} rad/s; expected finite numbers"
        )


def clamped(twist: Twist2D, limits: BaseLimits) -> Twist2D:
    """A velocity command within the velocity limits; CommandError for NaN or infinity."""
    require_finite(twist)
    v, w = max(-limits.max_v, min(limits.max_v, twist.v)), max(-limits.max_w, min(limits.max_w, twist.w))
    return Twist2D(v, w)
