"""Pacing, pausing and spans by a clock that the test advances; test_simulation.py has them in the loop."""

import pytest
from fakes import FakeClock

from aro_robocop_goto_as.simulation.time_control import (
    LONGEST_HOLD,
    MOST_BEHIND,
    PAUSED_PERIOD,
    REST,
    REST_PERIOD,
    Pacer,
    TimeControl,
    TimeParams,
)

RATE = 240  # [Hz] of the steps


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
    assert not span.done()
    assert time.end_span(220) and span.result(0) == 220 and not time.end_span(220)
    assert time.standing


def test_time_that_was_paused_is_not_caught_up() -> None:
    clock = FakeClock()
    time = TimeControl(TimeParams(), 240, clock)
    time.set_paused(True, 240)
    clock.time += 60.0
    time.set_paused(False, 240)
    assert time.hold(264) == pytest.approx(0.1)


def test_pacer_waits_for_the_simulated_time_divided_by_the_factor() -> None:
    wall = FakeClock()
    timing = Pacer(2.0, RATE, wall.now)
    assert timing.ahead(240) == pytest.approx(0.5)
    wall.time += 0.5
    assert timing.ahead(240) == 0.0


def test_factor_zero_waits_for_rests_only() -> None:
    wall = FakeClock()
    timing = Pacer(0.0, RATE, wall.now)
    assert timing.ahead(10**12) == 0.0
    wall.time += REST_PERIOD
    assert timing.ahead(10**12) == REST
    assert timing.ahead(10**12) == 0.0


def test_waits_count_as_rests() -> None:
    wall = FakeClock()
    timing = Pacer(0.0, RATE, wall.now)
    wall.time += REST_PERIOD
    timing.waited(REST)
    assert timing.ahead(10**12) == 0.0


def test_long_lag_is_dropped_and_not_caught_up_in_a_burst() -> None:
    wall = FakeClock()
    timing = Pacer(1.0, RATE, wall.now)
    wall.time += 5.0
    assert timing.ahead(240) == REST
    assert timing.ahead(240) == 0.0
    assert timing.ahead(264) == pytest.approx(0.1)


def test_report_contains_the_achieved_factor() -> None:
    wall = FakeClock()
    timing = Pacer(4.0, RATE, wall.now)
    wall.time += 0.5
    assert timing.report(240) is None
    wall.time += 0.5
    timing.ahead(480)
    report = timing.report(480)
    assert (report.reached, report.asked, report.behind) == (pytest.approx(2.0), 4.0, True)


@pytest.mark.parametrize("late, behind", [(MOST_BEHIND - 0.01, False), (MOST_BEHIND + 0.01, True)])
def test_a_lag_that_will_be_made_up_for_does_not_count_as_behind(late: float, behind: bool) -> None:
    wall = FakeClock()
    timing = Pacer(1.0, RATE, wall.now)
    wall.time += 1.0 + late
    timing.ahead(RATE)
    report = timing.report(RATE)
    assert report is not None and report.behind == behind


def test_a_clock_slower_than_the_reports_is_not_behind() -> None:
    wall = FakeClock()
    timing = Pacer(0.01, RATE, wall.now)
    wall.time += 1.0
    assert timing.ahead(4) > 0.0
    report = timing.report(0)
    assert report is not None and (report.reached, report.behind) == (0.0, False)
