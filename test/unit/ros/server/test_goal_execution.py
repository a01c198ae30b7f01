"""One goal's control periods: the velocity and the feedback, and when lack of progress or the timeout ends it."""

import math
from types import SimpleNamespace

import pytest
from aro_robocop_goto_as.msg import GoToPositionGoal
from geometry_msgs.msg import Point

from aro_robocop_goto_as.geometry import STANDSTILL, Pose2D
from aro_robocop_goto_as.goto.params import GotoParams
from aro_robocop_goto_as.goto.rule import EndGoal, Errors, MoveForward, Outcome, Rotate
from aro_robocop_goto_as.ros.server.goal_execution import GoalExecution, feedback_of

PERIOD = 100  # [ms] of the control loop
PERIODS = range(0, 600_000, PERIOD)
BLOCKED = [Pose2D()] * len(PERIODS)  # the robot never moves


def goal_at_x_1():
    inputs = SimpleNamespace(odom=None)  # whose frame a text would name
    return GoalExecution(GoToPositionGoal(Point(1.0, 0.0, 0.0)), inputs)


def end_of_goal(poses, goal_timeout=0.0):
    """The time [ms] at which a goal at x 1 ends, and how, with the robot at these poses in each period."""
    p, goal = GotoParams(goal_timeout=goal_timeout), goal_at_x_1()
    for time, pose in zip(PERIODS, poses):
        goal.begin_period(time / 1000.0)
        ending = goal.ending(goal.decide(pose, math.inf, p), math.inf, p)
        if ending is not None:
            return time, ending.outcome
    raise AssertionError("the goal did not end")


def test_velocity_grows_by_the_acceleration_limit_in_each_control_period():
    p, goal = GotoParams(), goal_at_x_1()
    for periods in (1, 2):
        goal.decide(Pose2D(), math.inf, p)
        assert goal.twist.v == pytest.approx(periods * p.linear_acceleration / p.control_rate)


@pytest.mark.parametrize(
    "decision, text",
    [
        (Rotate(Errors(1.5, -0.25), STANDSTILL), "rotating, -0.25 rad to go"),
        (MoveForward(Errors(1.5, -0.25), STANDSTILL), "driving, 1.50 m to go"),
        (EndGoal(Errors(1.5, -0.25), Outcome.OBSTACLE), "obstacle"),
    ],
)
def test_feedback_holds_both_errors_and_what_the_robot_does(decision, text):
    feedback = feedback_of(decision)
    assert (feedback.position_error, feedback.angle_error, feedback.message) == (1.5, -0.25, text)


def test_goal_ends_at_its_timeout():
    assert end_of_goal(BLOCKED, goal_timeout=3.0) == (3_000 + PERIOD, Outcome.TIMEOUT)


def test_goal_without_progress_ends_after_the_timeout():
    assert end_of_goal(BLOCKED) == (5_000 + PERIOD, Outcome.STUCK)
