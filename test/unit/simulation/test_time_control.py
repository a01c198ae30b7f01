"""Pausing and spans by numbers of steps; test_simulation.py has them in the loop."""

import pytest
from fakes import FakeClock

from aro_robocop_goto_as.sim_params import TimeParams
from aro_robocop_goto_as.simulation.time_control import LONGEST_HOLD, PAUSED_PERIOD, TimeControl


def test_hold_is_short_enough_to_look_at_what_else_is_due() -> None:
    clock = FakeClock()
    time = TimeControl(TimeParams(real_time_factor=0.001), 240, clock)
    assert time.hold(240) == LONGEST_HOLD
    time.set_paused(True, 240)
    assert time.hold(240) == PAUSED_PERIOD


def test_clock_is_repeated_only_while_time_stands_still() -> None:
    clock = FakeClock()
    time = TimeControl(TimeParams(start_paused=True), 240, clock)
    assert [time.repetition_due(), time.repetition_due()] == [True, False]
    clock.time += PAUSED_PERIOD
    assert time.repetition_due()
    clock.time += PAUSED_PERIOD
    time.begin_span(1.0, 0)
    assert not time.repetition_due()


def test_no_step_is_made_beyond_the_end_of_a_span() -> None:
    time = TimeControl(TimeParams(), 240, FakeClock())
    assert time.steps_left(5) > 10**6
    span = time.begin_span(0.5, 100)
    assert span is not None and time.steps_left(130) == 90 and not time.end_span(219)
    time.shift_span(100)
    assert time.steps_left(30) == 90 and not span.done()
    assert time.end_span(120) and span.result(0) == 120 and not time.end_span(120)
    assert time.standing


def test_time_that_was_paused_is_not_caught_up() -> None:
    clock = FakeClock()
    time = TimeControl(TimeParams(), 240, clock)
    time.set_paused(True, 240)
    clock.time += 60.0
    time.set_paused(False, 240)
    assert time.hold(264) == pytest.approx(0.1)
