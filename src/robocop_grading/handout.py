"""Names and figures that the lab's handout prescribes, and the tolerances around them."""

import math
from dataclasses import dataclass

ACTION = "/robocop_goto_as"
ACTION_TYPE = "aro_robocop_goto_as/GoToPositionAction"
CLICKS = "/move_base_simple/goal"  # where RViz publishes a 2D Nav Goal
GOAL_RADIUS = 0.1  # [m] a smaller position_error means that the goal is reached
HEADING_TOLERANCE = 0.1  # [rad] within it the robot drives straight, beyond it the robot turns
STOP_DISTANCE = 0.3  # [m] a closer obstacle ahead aborts the goal
AHEAD = math.radians(30.0)  # [rad] beams within +- this angle count as ahead


@dataclass(frozen=True)
class Limits:
    """Tolerances that the checks compare with; config/grading.yaml explains each one."""

    feedback_low: float = 7.0
    feedback_high: float = 35.0
    position_tolerance: float = 0.06
    angle_tolerance: float = 0.12
    turn_beyond: float = 0.16
    straight_within: float = 0.07
    driving: float = 0.02
    straight_turn: float = 0.35
    reached: float = 0.12
    abort_nearest: float = 0.2
    abort_farthest: float = 0.36
    preempt_within: float = 1.5
    stop_within: float = 1.0
    standing_v: float = 0.01
    standing_w: float = 0.05
    status_reports: int = 2
    status_span: float = 20.0
    stall: float = 8.0
    stall_distance: float = 0.01
    stall_angle: float = 0.05
    goal_time: float = 400.0
