"""The lab's control rule as a pure function of pose, clearance, goal and parameters."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from aro_robocop_goto_as.geometry import STANDSTILL, Pose2D, Twist2D
from aro_robocop_goto_as.goto.params import GotoParams
from aro_robocop_goto_as.goto.rule import (
    EndGoal,
    Errors,
    Goal,
    Outcome,
    decide,
    errors_to,
    limit_acceleration,
    track_progress,
)

P = GotoParams()
near = st.floats(-20.0, 20.0)
poses = st.builds(Pose2D, near, near, st.floats(-math.pi, math.pi))
goals = st.builds(Goal, near, near)


@given(poses, goals)
def test_errors_are_distance_and_bearing_from_the_robot_to_the_goal(pose, goal):
    assert errors_to(goal, Pose2D(goal.x, goal.y, pose.yaw)) == Errors(0.0, 0.0)
    errors = errors_to(goal, pose)
    assert -math.pi <= errors.angle <= math.pi
    heading = pose.yaw + errors.angle
    if errors.position > 0.0:
        assert pose.x + errors.position * math.cos(heading) == pytest.approx(goal.x, abs=1e-9)
        assert pose.y + errors.position * math.sin(heading) == pytest.approx(goal.y, abs=1e-9)


@pytest.mark.parametrize(
    "distance, yaw, clearance, expected",
    [
        (0.0999, 0.0, 5.0, Outcome.REACHED),
        (0.0999, 1.0, 0.0, Outcome.REACHED),
        (0.1, 0.0, 5.0, Twist2D(0.05, 0.0)),
        (0.3, 0.0, math.inf, Twist2D(0.15, 0.0)),
        (5.0, 0.0, 0.3, Twist2D(0.2, 0.0)),
        (5.0, 0.0, 0.2999, Outcome.OBSTACLE),
        (5.0, 0.1, 5.0, Twist2D(0.2, 0.0)),
        (5.0, 0.15, 0.0, Twist2D(0.0, -0.75)),
        (5.0, -0.15, 0.0, Twist2D(0.0, 0.75)),
        (5.0, 1.0, 5.0, Twist2D(0.0, -1.0)),
        (5.0, -1.0, 5.0, Twist2D(0.0, 1.0)),
    ],
)
def test_handouts_rule_ends_the_goal_else_turns_towards_it_else_drives_straight(distance, yaw, clearance, expected):
    decision = decide(Pose2D(0.0, 0.0, yaw), clearance, Goal(distance, 0.0), P)
    assert decision.errors == Errors(distance, -yaw)
    assert decision.twist == (STANDSTILL if isinstance(expected, Outcome) else pytest.approx(expected))
    assert not isinstance(expected, Outcome) or (isinstance(decision, EndGoal) and decision.outcome is expected)


def test_rule_asks_for_the_minimum_velocities_where_the_gains_give_less():
    slow = GotoParams(linear_gain=0.01, angular_gain=0.01)
    assert decide(Pose2D(), math.inf, Goal(1.0, 0.0), slow).twist == (0.03, 0.0)
    assert decide(Pose2D(), math.inf, Goal(0.0, 1.0), slow).twist == (0.0, 0.3)


@pytest.mark.parametrize(
    "previous, yaw, expected",
    [
        (Twist2D(0.0, 0.0), 0.0, (0.05, 0.0)),
        (Twist2D(0.18, 0.0), 0.0, (0.2, 0.0)),
        (Twist2D(0.3, 0.0), 0.0, (0.25, 0.0)),
        (Twist2D(0.0, 0.5), 0.0, (0.05, 0.0)),
        (Twist2D(0.0, 0.0), -1.0, (0.0, 0.3)),
        (Twist2D(0.2, 0.0), 1.0, (0.0, -0.3)),
        (Twist2D(0.0, 0.9), 1.0, (0.0, 0.6)),
    ],
)
def test_commands_accelerate_within_limits_and_never_turn_while_driving(previous, yaw, expected):
    decision = decide(Pose2D(0.0, 0.0, yaw), math.inf, Goal(5.0, 0.0), P)
    assert limit_acceleration(previous, decision, 0.1, P) == pytest.approx(expected)


def test_robot_stops_at_once_where_its_goal_ends():
    assert limit_acceleration(Twist2D(0.2), decide(Pose2D(), math.inf, Goal(0.0, 0.0), P), 0.1, P) == STANDSTILL


def test_coming_nearer_or_turning_towards_the_goal_is_progress():
    moved = P.stuck_distance, P.stuck_angle
    start = track_progress(None, Errors(1.0, 0.5), 0.0, *moved)
    assert track_progress(start, Errors(0.995, 0.48), 4.0, *moved).since == 0.0
    assert track_progress(start, Errors(0.98, 0.5), 4.0, *moved).since == 4.0
    assert track_progress(start, Errors(1.0, 0.44), 4.0, *moved).since == 4.0
    assert track_progress(start, Errors(1.2, 0.6), 4.0, *moved).since == 0.0


def test_value_of_an_outcome_is_its_name():
    assert [outcome.value for outcome in Outcome] == [outcome.name for outcome in Outcome]
