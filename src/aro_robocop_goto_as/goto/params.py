"""The parameters of the action server. cfg/Goto.cfg reads them at build time, so nothing but Python is needed here."""

import math
from dataclasses import asdict, dataclass, fields
from typing import Any, List, Mapping

from ..param_loading import from_dict, parameter, positive

MAX_LINEAR = 10.0  # [m/s], [m/s^2] far above every model's limits, to which the base controller clamps commands anyway
MAX_ANGULAR = 100.0  # [rad/s], [rad/s^2] the same for turning
MAX_GAIN = 100.0  # [1/s] with which all but the last millimetres are covered at maximum velocity
MIN_TOLERANCE = 1e-3  # [m], [rad] what odometry resolves
MIN_GAIN = 0.01  # [1/s] slower than anybody waits
MIN_SPEED = 1e-3  # [m/s], [rad/s] slower than anybody waits
MIN_ACCELERATION = 0.01  # [m/s^2], [rad/s^2] slower than anybody waits
MAX_OBSTACLE_DISTANCE = 1e3  # [m] beyond every scanner's range


@dataclass(frozen=True)
class GotoParams:
    """Parameters of robocop_goto_as; config/goto_as.yaml documents each one."""

    control_rate: float = positive(10.0, high=1000.0)
    position_tolerance: float = parameter(0.1, low=MIN_TOLERANCE, high=1e3)
    angle_tolerance: float = parameter(0.1, low=MIN_TOLERANCE, high=math.pi)
    obstacle_distance: float = parameter(0.3, low=0.0, high=MAX_OBSTACLE_DISTANCE)
    obstacle_half_angle: float = parameter(math.pi / 6.0, low=0.0, high=math.pi)

    linear_gain: float = parameter(0.5, low=MIN_GAIN, high=MAX_GAIN)
    angular_gain: float = parameter(5.0, low=MIN_GAIN, high=MAX_GAIN)
    max_linear_velocity: float = parameter(0.2, low=MIN_SPEED, high=MAX_LINEAR)
    min_linear_velocity: float = parameter(0.03, low=MIN_SPEED, high=MAX_LINEAR)
    max_angular_velocity: float = parameter(1.0, low=MIN_SPEED, high=MAX_ANGULAR)
    min_angular_velocity: float = parameter(0.3, low=MIN_SPEED, high=MAX_ANGULAR)
    linear_acceleration: float = parameter(0.5, low=MIN_ACCELERATION, high=MAX_LINEAR)
    angular_acceleration: float = parameter(3.0, low=MIN_ACCELERATION, high=MAX_ANGULAR)

    data_timeout: float = positive(1.0)
    stuck_timeout: float = positive(5.0)
    stuck_distance: float = positive(0.01)
    stuck_angle: float = positive(0.05)
    goal_timeout: float = parameter(0.0, low=0.0)

    def conflicts(self) -> List[str]:
        """Combinations of values that are impossible, in words; empty when there are none."""
        problems = []
        for kind in ("linear", "angular"):
            low, high = getattr(self, f"min_{kind}_velocity"), getattr(self, f"max_{kind}_velocity")
            if low > high:
                problems.append(f"min_{kind}_velocity: expected at most max_{kind}_velocity {high:g}, got {low:g}")
        return problems


def tuned(p: GotoParams, changes: Mapping[str, Any]) -> GotoParams:
    """The parameters with some values replaced; ParameterError if the result is impossible."""
    return from_dict(GotoParams, {**asdict(p), **changes}, "changed parameters")


def differences(old: GotoParams, new: GotoParams) -> List[str]:
    """Each parameter that differs, with both values, in words."""
    pairs = [(spec.name, getattr(old, spec.name), getattr(new, spec.name)) for spec in fields(GotoParams)]
    return [f"{name} {after:g}, was {before:g}" for name, before, after in pairs if after != before]
