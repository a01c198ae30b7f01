"""StatusTopics: a warning for a machine that is too slow for the requested factor, and none for any other one."""

from unittest.mock import MagicMock

import pytest
from fakes import FakeClock

from aro_robocop_goto_as.ros.sim import status
from aro_robocop_goto_as.simulation.params import SimParams
from aro_robocop_goto_as.simulation.time_control import Pacer

RATE = 240  # [Hz]


def warnings_at(monkeypatch, asked, reached):
    """The warnings of a simulator that reaches these factors, one a second, while another one is asked for."""
    clock, warnings, running = FakeClock(), [], MagicMock()
    running.time_control.pacer = Pacer(asked, RATE, clock.now)
    running.time_control.paused = False
    running.simulator.steps = 0
    monkeypatch.setattr(status, "publisher", MagicMock())
    monkeypatch.setattr(status.StatusTopics, "publish", lambda _: None)
    monkeypatch.setattr(status.rospy, "logwarn", lambda text, *values: warnings.append(text % values))
    topics = status.StatusTopics(running)
    for factor in reached:
        clock.time += 1.0
        running.simulator.steps += round(factor * RATE)
        running.time_control.pacer.wait_time(running.simulator.steps)
        assert topics.publish_due()
    return warnings


@pytest.mark.parametrize("setting, count", [({}, 1), ({"odom_slip": 0.1}, 0), ({"odom_wheel_radius_error": 0.05}, 0)])
def test_wheels_that_slipped_are_told_once_with_the_remedy_unless_errors_of_odometry_are_set(
    monkeypatch, setting, count
):
    warnings, running = [], MagicMock()
    running.simulator.params = SimParams.of(**setting)
    running.simulator.robots = [MagicMock()]
    running.simulator.robots[0].name, running.simulator.robots[0].model.figures.footprint_radius = "", 0.1
    monkeypatch.setattr(status, "publisher", MagicMock())
    monkeypatch.setattr(status, "odometry_error", lambda *_: 0.2)
    monkeypatch.setattr(status.rospy, "logwarn", lambda text, *values: warnings.append(text % values))
    topics = status.StatusTopics(running)
    for _ in range(2):
        topics._watch_slip()
    assert len(warnings) == count
    assert all(text.endswith(": ./robocop shell rosservice call /robocop_sim/reset 0") for text in warnings)


def test_a_factor_that_is_kept_is_no_reason_for_a_warning(monkeypatch):
    assert warnings_at(monkeypatch, 0.25, [0.25, 0.24, 0.25]) == []


def test_a_machine_that_is_too_slow_is_warned_of_once(monkeypatch):
    (warning,) = warnings_at(monkeypatch, 4.0, [4.0, 2.0, 1.0])
    assert warning.startswith("real-time factor 2.00 achieved, 4.00 requested: this machine is too slow")
