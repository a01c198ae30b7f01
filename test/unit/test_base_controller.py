"""Velocity limits, acceleration limits, command timeout, wheel speeds."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from aro_robocop_goto_as.errors import CommandError
from aro_robocop_goto_as.geometry import Twist2D
from aro_robocop_goto_as.robot.base_controller import STANDING, Limits, accept, advance, wheel_speeds

LIMITS = Limits(max_v=0.22, max_w=2.84, max_dv=2.5, max_dw=3.2, timeout=0.5)
FOR_EVER = Limits(max_v=0.22, max_w=2.84, max_dv=2.5, max_dw=3.2, timeout=0.0)
DT = 1.0 / 240.0
commands = st.builds(Twist2D, st.floats(-1e6, 1e6), st.floats(-1e6, 1e6))


@given(st.lists(commands, max_size=20))
def test_velocity_and_acceleration_never_exceed_their_limits(sent: "list[Twist2D]") -> None:
    state, now = STANDING, 0.0
    for command in sent:
        state = accept(state, command, now, LIMITS)
        now += DT
        before, state = state, advance(state, now, DT, LIMITS)
        assert abs(state.velocity.v) <= LIMITS.max_v and abs(state.velocity.w) <= LIMITS.max_w
        assert abs(state.velocity.v - before.velocity.v) <= LIMITS.max_dv * DT + 1e-12
        assert abs(state.velocity.w - before.velocity.w) <= LIMITS.max_dw * DT + 1e-12


def _forward_speed_after(limits: Limits, seconds: float) -> float:
    state = accept(STANDING, Twist2D(0.2, 0.0), 0.0, limits)
    for step in range(1, int(seconds / DT) + 1):
        state = advance(state, step * DT, DT, limits)
    return state.velocity.v


def test_robot_follows_a_command_until_the_timeout_and_then_brakes() -> None:
    assert _forward_speed_after(LIMITS, 0.49) == pytest.approx(0.2)
    assert _forward_speed_after(LIMITS, 0.49 + 0.2 / 2.5 + 0.05) == 0.0


def test_with_timeout_zero_a_command_stays_in_force_forever() -> None:
    assert _forward_speed_after(FOR_EVER, 60.0) == pytest.approx(0.2)


@pytest.mark.parametrize("bad", [Twist2D(math.nan, 0.0), Twist2D(0.0, math.inf), Twist2D(-math.inf, math.nan)])
def test_non_finite_command_is_refused_with_its_values(bad: Twist2D) -> None:
    with pytest.raises(CommandError, match=f"linear.x {bad.v} m/s, angular.z {bad.w} rad/s"):
        accept(STANDING, bad, 0.0, LIMITS)


@given(st.floats(-1, 1), st.floats(-3, 3))
def test_wheel_speeds_reproduce_the_commanded_twist(v: float, w: float) -> None:
    left, right = wheel_speeds(Twist2D(v, w), 0.033, 0.16)
    assert (left + right) / 2.0 * 0.033 == pytest.approx(v, abs=1e-9)
    assert (right - left) * 0.033 / 0.16 == pytest.approx(w, abs=1e-9)
