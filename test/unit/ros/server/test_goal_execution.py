"""One goal's control periods: when lack of progress ends it."""

import math
from types import SimpleNamespace
from typing import Any, Iterable, Tuple

import pytest
from aro_robocop_goto_as.msg import GoToPositionGoal
from geometry_msgs.msg import Point

from aro_robocop_goto_as.geometry import Pose2D
from aro_robocop_goto_as.goto import Outcome
from aro_robocop_goto_as.goto_params import GotoParams
from aro_robocop_goto_as.ros.server.goal_execution import GoalExecution

PERIOD = 100  # [ms] of the control loop
PERIODS = range(0, 600_000, PERIOD)
BLOCKED = [Pose2D()] * len(PERIODS)  # the robot never moves
OTHER_WAY = [n // (4_000 // PERIOD) % 2 == 1 for n in range(1, len(PERIODS) + 1)]  # changes every 4 s


def end_of_goal(poses: Iterable[Pose2D]) -> Tuple[int, Outcome]:
    """The time [ms] at which a goal at x 1 ends, and how, with the robot at these poses in each period."""
    p, inputs = GotoParams(), SimpleNamespace(odom=None)  # whose frame a text would name
    anything: Any = inputs
    goal = GoalExecution(GoToPositionGoal(Point(1.0, 0.0, 0.0)), anything)
    for time, pose in zip(PERIODS, poses):
        goal.begin_period(time / 1000.0)
        ending = goal.ending(goal.decide(pose, math.inf, p), math.inf, p)
        if ending is not None:
            return time, ending.outcome
    raise AssertionError("the goal did not end")


def test_goal_without_progress_ends_after_the_timeout() -> None:
    assert end_of_goal(BLOCKED) == (5_000 + PERIOD, Outcome.STUCK)


def test_a_turn_at_a_lower_speed_gets_its_own_time_and_there_are_two_of_them() -> None:
    ended, outcome = end_of_goal(Pose2D(yaw=0.5 if other else -0.5) for other in OTHER_WAY)
    assert outcome is Outcome.STUCK
    assert ended == pytest.approx(8_000 + 5_000, abs=3 * PERIOD)


def test_robot_that_is_carried_away_gets_its_time_anew() -> None:
    xs = [*(0.02 * n for n in range(44)), *(-3.0 + 0.02 * n for n in range(200))]
    assert end_of_goal(map(Pose2D, xs))[1] is Outcome.REACHED
