"""Pacing, pausing and spans by a clock that the test advances; test_simulation.py has them in the loop."""

import pytest
from fakes import FakeClock

from aro_robocop_goto_as.simulation.time_control import (
    REST,
    REST_PERIOD,
    Pacer,
)

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
