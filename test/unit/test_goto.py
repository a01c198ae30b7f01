"""The lab's control rule as a pure function of pose, clearance, goal and parameters."""

import math
from typing import Any, List, Optional, Tuple

import pytest
from hypothesis import given
from hypothesis import strategies as st

from aro_robocop_goto_as.geometry import STANDSTILL, Pose2D, Twist2D, wrap_angle
from aro_robocop_goto_as.goto import (
    End,
    Errors,
    Goal,
    MoveForward,
    Outcome,
    Progress,
    Rotate,
    Turning,
    decide,
    errors_to,
    has_jumped,
    limit_acceleration,
    track_progress,
)
from aro_robocop_goto_as.goto_params import GotoParams

P = GotoParams()
near = st.floats(-20.0, 20.0)
poses = st.builds(Pose2D, near, near, st.floats(-math.pi, math.pi))
goals = st.builds(Goal, near, near)
clearances = st.one_of(st.floats(0.0, 12.0), st.just(math.inf))
twists = st.one_of(
    st.builds(Twist2D, st.just(0.0), st.floats(-1, 1)), st.builds(Twist2D, st.floats(0, 0.2), st.just(0.0))
)


@given(poses, goals)
def test_errors_are_distance_and_bearing_from_the_robot_to_the_goal(pose: Pose2D, goal: Goal) -> None:
    errors = errors_to(goal, pose)
    assert -math.pi <= errors.angle <= math.pi
    heading = pose.yaw + errors.angle
    if errors.position > 0.0:
        assert pose.x + errors.position * math.cos(heading) == pytest.approx(goal.x, abs=1e-9)
        assert pose.y + errors.position * math.sin(heading) == pytest.approx(goal.y, abs=1e-9)


@given(poses, clearances, goals)
def test_decisions_follow_the_handouts_rule(pose: Pose2D, clearance: float, goal: Goal) -> None:
    decision = decide(pose, clearance, goal, P)
    errors = decision.errors
    if errors.position < 0.1:
        assert isinstance(decision, End) and decision.outcome is Outcome.REACHED
    elif abs(errors.angle) > 0.1:
        assert isinstance(decision, Rotate)
    elif clearance < 0.3:
        assert isinstance(decision, End) and decision.outcome is Outcome.OBSTACLE
    else:
        assert isinstance(decision, MoveForward)


@given(poses, clearances, goals)
def test_the_robot_turns_towards_the_goal_or_drives_straight_within_its_limits(
    pose: Pose2D, clearance: float, goal: Goal
) -> None:
    decision = decide(pose, clearance, goal, P)
    twist = decision.twist
    if isinstance(decision, Rotate):
        assert twist.v == 0.0 and twist.w * decision.errors.angle > 0.0
        assert P.min_angular_velocity <= abs(twist.w) <= P.max_angular_velocity
    elif isinstance(decision, MoveForward):
        assert twist.w == 0.0 and P.min_linear_velocity <= twist.v <= P.max_linear_velocity
    else:
        assert twist == STANDSTILL


@given(st.floats(0.1, 10.0), st.floats(0.1, 10.0))
def test_speed_never_rises_as_the_goal_comes_nearer(a: float, b: float) -> None:
    less, more = sorted((a, b))
    slow, fast = (decide(Pose2D(), math.inf, Goal(x, 0.0), P).twist.v for x in (less, more))
    assert slow <= fast


def test_robot_is_slow_when_it_reaches_the_tolerance() -> None:
    assert decide(Pose2D(), math.inf, Goal(0.1001, 0.0), P).twist.v <= 0.06


@given(twists, poses, clearances, goals)
def test_commands_accelerate_within_limits_and_never_turn_while_driving(
    previous: Twist2D, pose: Pose2D, clearance: float, goal: Goal
) -> None:
    decision = decide(pose, clearance, goal, P)
    twist = limit_acceleration(previous, decision, 0.1, P)
    assert twist.v == 0.0 or twist.w == 0.0
    if isinstance(decision, End):
        assert twist == STANDSTILL
    if isinstance(decision, Rotate):
        assert abs(twist.w - previous.w) <= P.angular_acceleration * 0.1 + 1e-12
    if isinstance(decision, MoveForward):
        assert abs(twist.v - previous.v) <= P.linear_acceleration * 0.1 + 1e-12


@given(st.floats(-5, 5), st.floats(-5, 5), st.floats(-math.pi, math.pi))
def test_an_ideal_robot_without_obstacles_always_arrives(x: float, y: float, yaw: float) -> None:
    pose, twist, goal = Pose2D(0.0, 0.0, yaw), STANDSTILL, Goal(x, y)
    for _ in range(1200):
        decision = decide(pose, math.inf, goal, P)
        if isinstance(decision, End):
            assert decision.outcome is Outcome.REACHED
            return
        twist = limit_acceleration(twist, decision, 0.1, P)
        pose = Pose2D(
            pose.x + 0.1 * twist.v * math.cos(pose.yaw),
            pose.y + 0.1 * twist.v * math.sin(pose.yaw),
            wrap_angle(pose.yaw + 0.1 * twist.w),
        )
    pytest.fail(f"not there after two minutes: {pose}")


@given(st.integers(0, 12), st.integers(0, 2), st.randoms(use_true_random=False), st.floats(-math.pi, math.pi))
def test_a_robot_whose_commands_arrive_late_arrives_all_the_same(
    delay: int, jitter: int, random: Any, yaw: float
) -> None:
    pose, goal, turning, twist = Pose2D(0.0, 0.0, yaw), Goal(1.0, 0.0), Turning(), STANDSTILL
    sent: List[Tuple[int, Twist2D]] = []  # with the control periods in which they arrive
    progress: Optional[Progress] = None
    for period in range(1200):
        decision = decide(pose, math.inf, goal, P, turning)
        if isinstance(decision, End):
            return
        before, turning = turning, turning.after(decision)
        if turning.limit(P) < before.limit(P):  # as GoalExecution does
            progress = None
        progress = track_progress(progress, decision.errors, 0.1 * period, P.stuck_distance, P.stuck_angle)
        assert 0.1 * period - progress.since <= P.stuck_timeout
        twist = limit_acceleration(twist, decision, 0.1, P)
        sent.append((period + delay + random.randint(0, jitter), twist))
        driven = next((late for arrival, late in reversed(sent) if arrival <= period), STANDSTILL)
        pose = Pose2D(
            pose.x + 0.1 * driven.v * math.cos(pose.yaw),
            pose.y + 0.1 * driven.v * math.sin(pose.yaw),
            wrap_angle(pose.yaw + 0.1 * driven.w),
        )
    pytest.fail(f"not there after two minutes: {pose}")


def test_each_reversal_halves_the_speed_of_turning_down_to_the_minimum() -> None:
    left, right = (decide(Pose2D(0.0, 0.0, yaw), math.inf, Goal(1.0, 0.0), P) for yaw in (-1.0, 1.0))
    turning = Turning().after(left).after(left)
    assert turning.limit(P) == P.max_angular_velocity
    assert turning.after(right).limit(P) == P.max_angular_velocity / 2.0
    assert Turning(1.0, 2000).limit(P) == P.min_angular_velocity


def test_coming_nearer_or_turning_towards_the_goal_is_progress() -> None:
    moved = P.stuck_distance, P.stuck_angle
    start = track_progress(None, Errors(1.0, 0.5), 0.0, *moved)
    assert track_progress(start, Errors(0.995, 0.48), 4.0, *moved).since == 0.0
    assert track_progress(start, Errors(0.98, 0.5), 4.0, *moved).since == 4.0
    assert track_progress(start, Errors(1.0, 0.44), 4.0, *moved).since == 4.0
    assert track_progress(start, Errors(1.2, 0.6), 4.0, *moved).since == 0.0


def test_only_what_no_driving_explains_is_a_jump() -> None:
    before = Errors(1.0, 0.0)
    assert not any(has_jumped(before, Errors(position, -1.09), P) for position in (0.0, 1.0, 1.29))
    assert has_jumped(before, Errors(1.31, 0.0), P)
    assert has_jumped(before, Errors(1.0, -1.11), P)
