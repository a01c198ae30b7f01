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


@pytest.mark.parametrize("bad", [Twist2D(math.nan, 0.0), Twist2D(0.0, math.inf), Twist2D(-math.inf, math.nan)])
def test_command_that_is_not_finite_is_refused_with_its_values(bad: Twist2D) -> None:
    with pytest.raises(CommandError, match=f"linear.x {bad.v} m/s, angular.z {bad.w} rad/s"):
        clamped(bad, Limits(0.22, 2.84, 2.5, 3.2, 0.5))


def test_limits_and_timeout_are_the_models_own_unless_a_parameter_overrides_them() -> None:
    burger, turtlebot2 = (model_named(name).figures for name in ("burger", "turtlebot2"))
    assert limits_from(SimParams().limits, burger) == (0.22, 2.84, 2.5, 3.2, 0.5)
    assert limits_from(SimParams().limits, turtlebot2) == (1.5, 6.6, 1.0, 2.0, 0.6)
    given = SimParams.of(max_linear_velocity=0.1, cmd_vel_timeout=0.0).limits
    assert limits_from(given, burger) == (0.1, 2.84, 2.5, 3.2, 0.0)
