"""The parameters of the action server. cfg/Goto.cfg reads them at build time, so nothing but Python is needed here."""

import math
from dataclasses import asdict, dataclass, fields
from functools import partial
from typing import Any, List, Mapping

from ..param_loading import from_dict, parameter, positive

MAX_LINEAR = 10.0  # [m/s], [m/s^2] far above every model's limits, to which the base controller clamps commands anyway
MAX_ANGULAR = 100.0  # [rad/s], [rad/s^2] the same for turning
MAX_GAIN = 100.0  # [1/s] with it, the robot slows down only in the last millimetres
MIN_TOLERANCE = 1e-3  # [m], [rad] what odometry resolves
MIN_GAIN = 0.01  # [1/s] slower than anybody waits
MIN_SPEED = 1e-3  # [m/s], [rad/s] slower than anybody waits
MIN_ACCELERATION = 0.01  # [m/s^2], [rad/s^2] slower than anybody waits
MAX_OBSTACLE_DISTANCE = 1e3  # [m] beyond every scanner's range

live = partial(parameter, live=True)  # cfg/Goto.cfg offers these to dynamic_reconfigure


@dataclass(frozen=True)
class GotoParams:
    """Parameters of robocop_goto_as."""

    control_rate: float = positive(10.0, "[Hz] of the control loop and its feedback (handout)", high=1000.0)
    position_tolerance: float = live(0.1, MIN_TOLERANCE, 1e3, "[m] the goal is reached within this distance (handout)")
    angle_tolerance: float = live(
        0.1, MIN_TOLERANCE, math.pi, "[rad] the robot turns in place beyond this angle_error, else drives (handout)"
    )
    obstacle_distance: float = live(
        0.3, 0.0, MAX_OBSTACLE_DISTANCE, "[m] an obstacle ahead nearer than this aborts the goal (handout)"
    )
    obstacle_half_angle: float = parameter(
        math.pi / 6.0, 0.0, math.pi, "[rad] ahead is 30 degrees to either side (the lab's skeleton)"
    )
    linear_gain: float = live(0.5, MIN_GAIN, MAX_GAIN, "[1/s] forward velocity per metre of position_error")
    angular_gain: float = live(5.0, MIN_GAIN, MAX_GAIN, "[1/s] angular velocity per radian of angle_error")
    max_linear_velocity: float = live(0.2, MIN_SPEED, MAX_LINEAR, "[m/s] slightly below the Burger's 0.22")
    min_linear_velocity: float = live(
        0.03, MIN_SPEED, MAX_LINEAR, "[m/s] near the goal, so that it is reached; acceleration starts below it"
    )
    max_angular_velocity: float = live(1.0, MIN_SPEED, MAX_ANGULAR, "[rad/s] of a turn in place")
    min_angular_velocity: float = live(0.3, MIN_SPEED, MAX_ANGULAR, "[rad/s] at small angles, so that a turn ends")
    linear_acceleration: float = live(0.5, MIN_ACCELERATION, MAX_LINEAR, "[m/s^2] of the commanded velocity")
    angular_acceleration: float = live(3.0, MIN_ACCELERATION, MAX_ANGULAR, "[rad/s^2] of the commanded velocity")
    data_timeout: float = positive(1.0, "[s] without odometry or a valid scan: the goal is aborted (NO_ODOM, NO_SCAN)")
    stuck_timeout: float = positive(5.0, "[s] without progress until the goal is aborted (STUCK)")
    stuck_distance: float = positive(0.01, "[m] closer to the goal by this much is progress")
    stuck_angle: float = positive(0.05, "[rad] turned towards the goal by this much is progress, too")
    goal_timeout: float = parameter(0.0, low=0.0, about="[s] until a goal is aborted (TIMEOUT); 0 = never")

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
