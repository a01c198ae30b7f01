"""The figures of a robot model that its URDF does not hold: footprint, limits of its base, command timeout."""

from dataclasses import dataclass

from ..param_loading import positive


@dataclass(frozen=True)
class ModelFigures:
    """Figures of one robot model, from config/models/NAME.yaml, which gives the source of each; all are required."""

    footprint_radius: float = positive(high=100.0)
    max_linear_velocity: float = positive()
    max_angular_velocity: float = positive()
    firmware_linear_velocity: float = positive()
    firmware_angular_velocity: float = positive()
    max_linear_acceleration: float = positive()
    max_angular_acceleration: float = positive()
    cmd_vel_timeout: float = positive()
