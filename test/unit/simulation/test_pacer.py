"""Pacing against a wall clock that the test advances."""

import pytest

from aro_robocop_goto_as.simulation import pacer

RATE = 240  # [Hz] of the steps


class Wall:
    def __init__(self) -> None:
        self.now = 100.0

    def __call__(self) -> float:
        return self.now


def test_pacer_waits_for_the_simulated_time_divided_by_the_factor() -> None:
    wall = Wall()
    timing = pacer.Pacer(2.0, RATE, wall)
    assert timing.ahead(240) == pytest.approx(0.5)
    wall.now += 0.5
    assert timing.ahead(240) == 0.0


def test_factor_zero_waits_for_rests_only() -> None:
    wall = Wall()
    timing = pacer.Pacer(0.0, RATE, wall)
    assert timing.ahead(10**12) == 0.0
    wall.now += pacer.REST_PERIOD
    assert timing.ahead(10**12) == pacer.REST
    assert timing.ahead(10**12) == 0.0


def test_waits_count_as_rests() -> None:
    wall = Wall()
    timing = pacer.Pacer(0.0, RATE, wall)
    wall.now += pacer.REST_PERIOD
    timing.waited(pacer.REST)
    assert timing.ahead(10**12) == 0.0


def test_long_lag_is_dropped_and_not_caught_up_in_a_burst() -> None:
    wall = Wall()
    timing = pacer.Pacer(1.0, RATE, wall)
    wall.now += 5.0
    assert timing.ahead(240) == pacer.REST
    assert timing.ahead(240) == 0.0
    assert timing.ahead(264) == pytest.approx(0.1)


def test_report_contains_the_achieved_factor() -> None:
    wall = Wall()
    timing = pacer.Pacer(4.0, RATE, wall)
    wall.now += 0.5
    assert timing.report(240) is None
    wall.now += 0.5
    report = timing.report(480)
    assert (report.reached, report.asked, report.behind) == (pytest.approx(2.0), 4.0, True)


def test_paused_time_is_not_caught_up() -> None:
    wall = Wall()
    timing = pacer.Pacer(1.0, RATE, wall)
    wall.now += 60.0
    timing.restart(720)
    assert timing.ahead(840) == pytest.approx(0.5)
