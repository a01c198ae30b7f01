"""Velocity limits, acceleration limits, command time-out, wheel speeds."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from aro_robocop_goto_as.drive import DriveLimits, accept, advance, standing, wheel_speeds
from aro_robocop_goto_as.errors import CommandError
from aro_robocop_goto_as.geometry import Twist2D

LIMITS = DriveLimits(max_v=0.22, max_w=2.84, max_dv=2.5, max_dw=3.2, timeout=0.5)
FOR_EVER = DriveLimits(max_v=0.22, max_w=2.84, max_dv=2.5, max_dw=3.2, timeout=0.0)
DT = 1.0 / 240.0
commands = st.builds(Twist2D, st.floats(-1e6, 1e6), st.floats(-1e6, 1e6))


@given(st.lists(commands, max_size=20))
def test_velocity_and_acceleration_never_exceed_their_limits(sent: "list[Twist2D]") -> None:
    state, now = standing(2), 0.0
    for command in sent:
        state = accept(state, 1, command, now, LIMITS)
        now += DT
        before, state = state, advance(state, now, DT, LIMITS)
        assert (abs(state.velocity) <= [LIMITS.max_v, LIMITS.max_w]).all()
        assert (abs(state.velocity - before.velocity) <= [LIMITS.max_dv * DT + 1e-12, LIMITS.max_dw * DT + 1e-12]).all()
        assert not state.velocity[0].any(), "a command for one robot moved another"


def _forward_speed_after(limits: DriveLimits, seconds: float) -> float:
    state = accept(standing(1), 0, Twist2D(0.2, 0.0), 0.0, limits)
    for step in range(1, int(seconds / DT) + 1):
        state = advance(state, step * DT, DT, limits)
    return float(state.velocity[0, 0])


def test_a_command_is_in_force_until_the_time_out_and_braked_after_it() -> None:
    assert _forward_speed_after(LIMITS, 0.49) == pytest.approx(0.2)
    assert _forward_speed_after(LIMITS, 0.49 + 0.2 / 2.5 + 0.05) == 0.0


def test_time_out_zero_holds_the_command_for_ever() -> None:
    assert _forward_speed_after(FOR_EVER, 60.0) == pytest.approx(0.2)


@pytest.mark.parametrize("bad", [Twist2D(math.nan, 0.0), Twist2D(0.0, math.inf), Twist2D(-math.inf, math.nan)])
def test_a_command_that_is_not_finite_is_refused_with_its_numbers(bad: Twist2D) -> None:
    with pytest.raises(CommandError, match=f"linear.x {bad.v} m/s, angular.z {bad.w} rad/s"):
        accept(standing(1), 0, bad, 0.0, LIMITS)


@given(st.floats(-1, 1), st.floats(-3, 3))
def test_wheel_speeds_add_up_to_the_twist_they_came_from(v: float, w: float) -> None:
    left, right = wheel_speeds(np.array([[v, w]]), 0.033, 0.16)[0]
    assert (left + right) / 2.0 * 0.033 == pytest.approx(v, abs=1e-9)
    assert (right - left) * 0.033 / 0.16 == pytest.approx(w, abs=1e-9)
