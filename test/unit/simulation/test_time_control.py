"""Pacing and spans by a clock that the test advances; test_running.py has them in the loop."""

import pytest
from fakes import FakeClock

from aro_robocop_goto_as.sim_params import TimeParams
from aro_robocop_goto_as.simulation.time_control import REST, REST_PERIOD, FactorReport, Pacer, TimeControl

RATE = 240  # [Hz] of the steps


def test_factor_zero_waits_for_rests_only() -> None:
    wall = FakeClock()
    timing = Pacer(0.0, RATE, wall.now)
    assert timing.ahead(10**12) == 0.0
    wall.time += REST_PERIOD
    assert timing.ahead(10**12) == REST
    assert timing.ahead(10**12) == 0.0


def test_long_lag_is_dropped_and_not_caught_up_in_a_burst() -> None:
    wall = FakeClock()
    timing = Pacer(1.0, RATE, wall.now)
    wall.time += 5.0
    assert timing.ahead(240) == REST
    assert timing.ahead(240) == 0.0
    assert timing.ahead(264) == pytest.approx(0.1)


def test_report_says_how_fast_time_went_what_a_step_took_and_how_much_lag_there_is_and_was_dropped() -> None:
    wall = FakeClock()
    timing = Pacer(2.0, RATE, wall.now)
    wall.time += 0.9
    assert timing.report(240) is None
    wall.time += 1.1
    timing.ahead(240)
    timing.waited(0.8)
    report = timing.report(240)
    assert report == FactorReport(0.5, 2.0, pytest.approx(1.2 / 240), pytest.approx(1.5), pytest.approx(1.5))
    assert report.behind
    wall.time += 1.05
    timing.ahead(720)
    assert timing.report(720) == FactorReport(
        pytest.approx(2.0 / 1.05), 2.0, pytest.approx(1.05 / 480), pytest.approx(0.05), 0.0
    )


def test_span_has_at_least_one_step_and_ends_there() -> None:
    time = TimeControl(TimeParams(start_paused=True), RATE, FakeClock())
    span = time.begin_span(0.0, 7)
    assert span is not None and time.steps_left(7) == 1 and not time.standing
    assert not time.end_span(7)
    assert time.end_span(8) and time.standing and span.result(0) == 8


def test_clock_is_repeated_once_a_period_while_time_stands_still() -> None:
    clock = FakeClock()
    time = TimeControl(TimeParams(start_paused=True), RATE, clock)
    assert [time.repetition_due(), time.repetition_due()] == [True, False]
    clock.time += 0.1
    assert time.repetition_due()
    time.set_paused(False, 0)
    clock.time += 0.1
    assert not time.repetition_due()
