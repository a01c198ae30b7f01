"""Pacing by a clock that the test advances; test_running.py has it in the loop."""

import pytest
from fakes import FakeClock

from aro_robocop_goto_as.simulation.time_control import REST, REST_PERIOD, Pace, Pacer

RATE = 240  # [Hz] of the steps


def test_factor_zero_waits_for_rests_only():
    wall = FakeClock()
    timing = Pacer(0.0, RATE, wall.now)
    assert timing.wait_time(10**12) == 0.0
    wall.time += REST_PERIOD
    assert timing.wait_time(10**12) == REST
    assert timing.wait_time(10**12) == 0.0


def test_long_lag_is_dropped_and_not_caught_up_in_a_burst():
    wall = FakeClock()
    timing = Pacer(1.0, RATE, wall.now)
    wall.time += 5.0
    assert timing.wait_time(240) == REST
    assert timing.wait_time(240) == 0.0
    assert timing.wait_time(264) == pytest.approx(0.1)


def test_pace_says_how_fast_time_went_what_a_step_took_and_how_much_lag_there_is_and_was_dropped():
    wall = FakeClock()
    timing = Pacer(2.0, RATE, wall.now)
    wall.time += 0.9
    assert timing.measure_pace(240) is None
    wall.time += 1.1
    timing.wait_time(240)
    timing.waited(0.8)
    pace = timing.measure_pace(240)
    assert pace == Pace(0.5, 2.0, pytest.approx(1.2 / 240), pytest.approx(1.5), pytest.approx(1.5))
    assert pace.behind
    wall.time += 1.05
    timing.wait_time(720)
    assert timing.measure_pace(720) == Pace(
        pytest.approx(2.0 / 1.05), 2.0, pytest.approx(1.05 / 480), pytest.approx(0.05), 0.0
    )
