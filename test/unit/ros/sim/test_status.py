"""StatusTopics: a warning for a machine that is too slow for the requested factor, and none for any other one."""

from typing import Any, List
from unittest.mock import MagicMock

import pytest
from fakes import FakeClock

from aro_robocop_goto_as.ros.sim import status
from aro_robocop_goto_as.simulation.time_control import Pacer

RATE = 240  # [Hz]


def warnings_at(monkeypatch: pytest.MonkeyPatch, asked: float, reached: List[float]) -> List[str]:
    """The warnings of a simulator that reaches these factors, one a second, while another one is asked for."""
    clock, warnings, running = FakeClock(), [], MagicMock()
    running.time_control.pacer = Pacer(asked, RATE, clock.now)
    running.time_control.paused = False
    running.simulator.steps = 0
    monkeypatch.setattr(status, "publisher", MagicMock())
    monkeypatch.setattr(status.StatusTopics, "publish", lambda _: None)
    monkeypatch.setattr(status.rospy, "logwarn", lambda text, *values: warnings.append(text % values))
    topics: Any = status.StatusTopics(running)
    for factor in reached:
        clock.time += 1.0
        running.simulator.steps += round(factor * RATE)
        running.time_control.pacer.wait_time(running.simulator.steps)
        assert topics.report()
    return warnings


def test_a_factor_that_is_kept_is_no_reason_for_a_warning(monkeypatch: pytest.MonkeyPatch) -> None:
    assert warnings_at(monkeypatch, 0.25, [0.25, 0.24, 0.25]) == []


def test_a_machine_that_is_too_slow_is_warned_of_once(monkeypatch: pytest.MonkeyPatch) -> None:
    (warning,) = warnings_at(monkeypatch, 4.0, [4.0, 2.0, 1.0])
    assert warning.startswith("real-time factor 2.00 achieved, 4.00 requested: this machine is too slow")
