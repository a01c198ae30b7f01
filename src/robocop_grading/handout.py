"""Names and figures that the lab's handout prescribes, and the tolerances around them."""

import math
from dataclasses import dataclass

from aro_robocop_goto_as.param_loading import parameter

ACTION = "/robocop_goto_as"
CLICK_TOPIC = "/move_base_simple/goal"  # where RViz publishes a 2D Nav Goal
GOAL_RADIUS = 0.1  # [m] a smaller position_error means that the goal is reached
HEADING_TOLERANCE = 0.1  # [rad] within it the robot drives straight, beyond it the robot turns
STOP_DISTANCE = 0.3  # [m] a closer obstacle ahead aborts the goal
AHEAD = math.radians(30.0)  # [rad] beams within +- this angle count as ahead


@dataclass(frozen=True)
class Limits:
    """Tolerances that the checks compare with; config/grading.yaml explains each one."""

    feedback_low: float = parameter(7.0, low=0)
    feedback_high: float = parameter(35.0, low=0)
    position_tolerance: float = parameter(0.06, low=0)
    angle_tolerance: float = parameter(0.12, low=0)
    turn_beyond: float = parameter(0.16, low=0)
    straight_within: float = parameter(0.07, low=0)
    driving: float = parameter(0.02, low=0)
    straight_turn: float = parameter(0.35, low=0)
    reached: float = parameter(0.12, low=0)
    abort_nearest: float = parameter(0.2, low=0)
    abort_farthest: float = parameter(0.36, low=0)
    preempt_within: float = parameter(1.5, low=0)
    stop_within: float = parameter(1.0, low=0)
    standing_v: float = parameter(0.01, low=0)
    standing_w: float = parameter(0.05, low=0)
    status_reports: int = parameter(2, low=0)
    status_span: float = parameter(20.0, low=0)
    stall: float = parameter(8.0, low=0)
    stall_distance: float = parameter(0.01, low=0)
    stall_angle: float = parameter(0.05, low=0)
    goal_time: float = parameter(400.0, low=0)

    @property
    def status_period(self) -> float:
        """The longest time [s] from one report of the bridge to the next."""
        return self.status_span / max(1, self.status_reports)
