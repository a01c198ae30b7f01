"""The server's view of its inputs: it changes in one piece, and what is missing is said in the right words."""

import time

import pytest
import rospy
from nav_msgs.msg import Odometry
from sensor_msgs.msg import LaserScan

from aro_robocop_goto_as.goto import Outcome
from aro_robocop_goto_as.params import GotoParams
from aro_robocop_goto_as.ros.server.inputs import FIRST_MESSAGE, Inputs


def scan_with(ahead: float) -> LaserScan:
    return LaserScan(angle_increment=0.1, range_max=5.0, ranges=[ahead])


@pytest.fixture
def inputs(monkeypatch):
    monkeypatch.setattr(rospy, "Subscriber", lambda *_, **__: None)
    monkeypatch.setattr("aro_robocop_goto_as.ros.server.inputs._now", lambda: 1.5)
    return Inputs(GotoParams())


def test_scan_of_nan_is_called_invalid_even_if_it_arrives_after_the_control_period_began(inputs):
    inputs._on_odom(Odometry())
    inputs._on_scan(scan_with(float("nan")))
    outcome, text = inputs.missing(now=1.45, started=0.0, accepted=0.0)
    assert outcome is Outcome.NO_SCAN
    assert "no valid beam ahead" in text


def test_topic_without_any_message_since_the_goal_was_accepted_may_be_connecting(inputs, monkeypatch):
    wall = [100.0]
    monkeypatch.setattr("aro_robocop_goto_as.ros.server.inputs.time.monotonic", lambda: wall[0])
    monkeypatch.setattr("aro_robocop_goto_as.ros.server.inputs.wait_until", lambda condition, timeout: condition())
    assert inputs.missing(now=50.0, started=0.0, accepted=100.0) is None
    wall[0] += FIRST_MESSAGE
    outcome, text = inputs.missing(now=50.0, started=0.0, accepted=100.0)
    assert outcome is Outcome.NO_ODOM and "so far" in text


def test_topic_that_fell_silent_after_the_goal_was_accepted_is_missing_at_once(inputs, monkeypatch):
    accepted = time.monotonic()
    inputs._on_odom(Odometry())
    inputs._on_scan(scan_with(2.0))
    monkeypatch.setattr("aro_robocop_goto_as.ros.server.inputs._now", lambda: 50.0)
    outcome, text = inputs.missing(now=50.0, started=0.0, accepted=accepted)
    assert outcome is Outcome.NO_ODOM and "for 48.5 s" in text


def test_new_scan_is_visible_only_once_it_is_known_whether_it_is_valid(inputs, monkeypatch):
    looked = []
    real = inputs._clearance_in

    def look_and_compute(message):
        looked.append(inputs.scan)
        return real(message)

    monkeypatch.setattr(inputs, "_clearance_in", look_and_compute)
    inputs._on_scan(scan_with(2.0))
    assert looked == [None]
    first = inputs.scan
    assert first is not None and inputs.valid_scan is first
    inputs._on_scan(scan_with(float("nan")))
    assert inputs.scan is not first and inputs.valid_scan is first
