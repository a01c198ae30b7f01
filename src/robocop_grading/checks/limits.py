"""The figures that the checks compare with."""

from dataclasses import dataclass


@dataclass(frozen=True)
class Limits:
    """Tolerances around the handout's figures; config/grading.yaml explains each one."""

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
    goal_time: float = 120.0
