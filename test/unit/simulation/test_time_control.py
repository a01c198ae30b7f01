"""Pacing, pausing and spans by a clock that the test advances; test_simulation.py has them in the loop."""

import pytest
from fakes import FakeClock

from aro_robocop_goto_as.simulation.time_control import (
    MOST_BEHIND,
    REST,
    REST_PERIOD,
    Pacer,
    TimeControl,
    TimeParams,
)

RATE = 240  # [Hz] of the steps


def test_time_that_was_paused_is_not_caught_up() -> None:
    clock = FakeClock()
    time = TimeControl(TimeParams(), 240, clock)
    time.set_paused(True, 240)
    clock.time += 60.0
    time.set_paused(False, 240)
    assert time.hold(264) == pytest.approx(0.1)


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
