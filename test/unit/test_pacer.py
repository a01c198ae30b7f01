"""Pacing against a wall clock that the test moves by hand."""

import importlib.util
import os

import pytest
from support import ROOT

# nodes/__init__ is plain, but the module is loaded by its path so that nothing of rospy comes along.
_spec = importlib.util.spec_from_file_location(
    "pacer", os.path.join(ROOT, "src", "aro_robocop_goto_as", "nodes", "pacer.py"))
assert _spec is not None and _spec.loader is not None
pacer = importlib.util.module_from_spec(_spec)
_spec.loader.exec_module(pacer)


class Wall:
    def __init__(self) -> None:
        self.now = 100.0

    def __call__(self) -> float:
        return self.now


def test_it_waits_for_the_wall_clock_divided_by_the_factor() -> None:
    wall = Wall()
    it = pacer.Pacer(2.0, wall)
    assert it.ahead(1.0) == pytest.approx(0.5)
    wall.now += 0.5
    assert it.ahead(1.0) == 0.0


def test_factor_zero_never_waits() -> None:
    assert pacer.Pacer(0.0, Wall()).ahead(1e9) == 0.0


def test_a_long_lag_is_given_up_and_not_caught_up_in_a_burst() -> None:
    wall = Wall()
    it = pacer.Pacer(1.0, wall)
    wall.now += 5.0
    assert it.ahead(1.0) == 0.0
    assert it.ahead(1.1) == pytest.approx(0.1)


def test_it_reports_the_factor_that_was_reached() -> None:
    wall = Wall()
    it = pacer.Pacer(4.0, wall)
    wall.now += 0.5
    assert it.report(1.0, 240) is None
    wall.now += 0.5
    report = it.report(2.0, 480)
    assert (report.reached, report.asked, report.behind) == (pytest.approx(2.0), 4.0, True)


def test_a_pause_does_not_count() -> None:
    wall = Wall()
    it = pacer.Pacer(1.0, wall)
    wall.now += 60.0
    it.restart(3.0)
    assert it.ahead(3.5) == pytest.approx(0.5)
