"""Limits and commands of base controllers, and base_controller.c against its definition."""

import ctypes
import math
from typing import List, Tuple

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from reference_fleet import controlled, wheel_speeds
from support import model_named

from aro_robocop_goto_as.errors import CommandError
from aro_robocop_goto_as.geometry import Twist2D
from aro_robocop_goto_as.robot.base_controller import Limits, clamped, limits_from
from aro_robocop_goto_as.robot.fleet import Fleet, library
from aro_robocop_goto_as.sim_params import SimParams

LIMITS = Limits(max_v=0.22, max_w=2.84, max_dv=2.5, max_dw=3.2, timeout=0.5)
DT = 1.0 / 240.0
speeds = st.one_of(st.sampled_from([0.0, 0.22, -0.22]), st.floats(-1e6, 1e6))
commands = st.lists(st.tuples(st.builds(Twist2D, speeds, speeds), st.integers(1, 60)), max_size=5)  # for some steps
Commands = List[Tuple[Twist2D, int]]
some_limits = st.builds(
    Limits, *[st.floats(1e-3, 10.0)] * 2, *[st.floats(1e-2, 1e3)] * 2, st.sampled_from([0.0, DT, 0.1, 0.5])
)


def _fleet(*limits: Limits) -> Fleet:
    return Fleet([model_named("burger")] * len(limits), limits, [0.1] * len(limits))


def _control(fleet: Fleet, now: float) -> bool:
    return bool(library().aro_control(ctypes.byref(fleet.struct), now, DT))


@given(st.lists(st.tuples(commands, some_limits), min_size=2, max_size=2))
def test_velocities_and_wheel_speeds_are_those_of_the_definition(runs: List[Tuple[Commands, Limits]]) -> None:
    fleet = _fleet(*(limits for _, limits in runs))
    for robot, (sent, limits) in enumerate(runs):
        velocity, step, reached, expected = np.zeros(2), 0, [], []
        most = limits.max_v, limits.max_w
        for command, steps in sent:
            fleet.commands[robot], fleet.commanded_at[robot] = clamped(command, limits), step * DT
            asked, since = np.clip(command, np.negative(most), most), step * DT
            for _ in range(steps):
                step += 1
                before = fleet.targets.copy()
                assert _control(fleet, step * DT) or (fleet.targets == before).all()
                velocity = controlled(velocity, asked, step * DT - since, np.array(limits), DT)
                reached.append([*fleet.velocities[robot], *fleet.targets[robot]])
                expected.append([*velocity, *wheel_speeds(velocity, *fleet.wheels[robot])])
        np.testing.assert_allclose(reached, expected, rtol=1e-12, atol=1e-8)
        assert (np.abs(np.array(reached).reshape(-1, 4)[:, :2]) <= most).all()


def _forward_speed_after(limits: Limits, seconds: float) -> float:
    fleet = _fleet(limits)
    fleet.commands[0] = 0.2, 0.0
    for step in range(1, int(seconds / DT) + 1):
        _control(fleet, step * DT)
    return float(fleet.velocities[0, 0])


def test_robot_follows_a_command_until_the_timeout_and_then_brakes() -> None:
    assert _forward_speed_after(LIMITS, 0.49) == pytest.approx(0.2)
    assert _forward_speed_after(LIMITS, 0.49 + 0.2 / 2.5 + 0.05) == 0.0


def test_with_timeout_zero_a_command_stays_in_force_for_ever() -> None:
    assert _forward_speed_after(LIMITS._replace(timeout=0.0), 60.0) == pytest.approx(0.2)


@pytest.mark.parametrize("bad", [Twist2D(math.nan, 0.0), Twist2D(0.0, math.inf), Twist2D(-math.inf, math.nan)])
def test_command_that_is_not_finite_is_refused_with_its_values(bad: Twist2D) -> None:
    with pytest.raises(CommandError, match=f"linear.x {bad.v} m/s, angular.z {bad.w} rad/s"):
        clamped(bad, LIMITS)


@pytest.mark.parametrize("model, timeout", [("burger", 0.5), ("waffle", 0.5), ("turtlebot2", 0.6)])
def test_robot_brakes_after_its_models_own_timeout_unless_another_one_is_given(model: str, timeout: float) -> None:
    figures = model_named(model).figures
    assert limits_from(SimParams().limits, figures).timeout == timeout
    assert limits_from(SimParams.of(cmd_vel_timeout=0.0).limits, figures).timeout == 0.0
