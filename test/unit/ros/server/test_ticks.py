"""Ticks are whole multiples of the period, and each one is answered once."""

import threading
import time as wall
from types import SimpleNamespace

import pytest
import rospy
from rosgraph_msgs.msg import Clock

from aro_robocop_goto_as.geometry import Twist2D
from aro_robocop_goto_as.ros.server import ticks
from aro_robocop_goto_as.ros.server.ticks import Ticks
from aro_robocop_goto_as.simulation.agenda import stamp_ns

MS = 1_000_000  # [ns]


class Time:
    """Simulated time, whose messages rospy hands to the ticks; the answers to ticks."""

    def __init__(self, monkeypatch, rate=10.0):
        self.now = rospy.Time()
        self.set_back = []
        self.answers = []
        monkeypatch.setattr(rospy, "get_rostime", lambda: self.now)
        monkeypatch.setattr(rospy, "get_param", lambda name, default: True)
        monkeypatch.setattr(
            rospy, "Subscriber", lambda topic, kind, callback, **_: setattr(self, "_callback", callback)
        )
        monkeypatch.setattr(ticks, "publisher", lambda *_: self)
        self.connections = {"answers": 1, "odom": 1}
        odom = SimpleNamespace(get_num_connections=lambda: self.connections["odom"])
        self.ticks = Ticks(rate, [odom], self.set_back.append)

    def get_num_connections(self):
        """As a publisher."""
        return self.connections["answers"]

    def publish(self, answer):
        """As a publisher."""
        self.answers.append((answer.tick.to_nsec() // MS, answer.has_command, answer.command.linear.x))

    def reach(self, milliseconds):
        """The clock shows this time."""
        self.now = rospy.Time.from_sec(milliseconds / 1000.0)
        self._callback(Clock(self.now))


@pytest.fixture(name="time")
def _time(monkeypatch):
    return Time(monkeypatch)


def never():
    """No interruption."""
    return False


@pytest.mark.parametrize("rate", [1, 5, 6, 7, 10, 15, 30, 60])
def test_each_tick_of_the_simulator_is_one_and_the_nanosecond_before_is_not(monkeypatch, rate):
    time = Time(monkeypatch, rate)
    for tick in range(1, 3 * rate + 1):
        stamp, previous = stamp_ns(tick, rate), stamp_ns(tick - 1, rate)
        for now, newest in ((stamp, stamp), (stamp - 1, previous)):
            time.now = rospy.Time(0, now)
            assert time.ticks.newest_ns() == newest


@pytest.mark.parametrize("before", [0, 99])
def test_wait_ends_at_the_next_tick(time, before):
    time.reach(before)
    waited = []
    waiting = threading.Thread(target=lambda: waited.append(time.ticks.wait_for_next(0, never)))
    waiting.start()
    time.reach(100)
    waiting.join(10.0)
    assert waited == [100 * MS]


def test_ticks_go_on_when_the_wall_clock_is_set_back(time, monkeypatch):
    monkeypatch.setattr(rospy, "get_param", lambda name, default: default)
    begin, ahead = wall.time(), [3600.0]
    monkeypatch.setattr(rospy, "get_rostime", lambda: rospy.Time.from_sec(wall.time() + ahead[0]))
    ticks = Ticks(100.0, [], time.set_back.append)
    last = ticks.newest_ns()
    ahead[0] = 0.0
    now = ticks.wait_for_next(last, never)
    assert begin * 1e9 < now < last
    ticks.answer(now)
    assert ticks.wait_for_next(ticks.answered_ns, never) > now
    assert time.set_back == []


def test_each_tick_is_answered_once_with_the_command_since_the_one_before(time):
    time.reach(0)
    for tick in (100, 100, 200):
        time.ticks.command = Twist2D(0.1, 0.0) if tick == 100 else None
        time.ticks.answer(tick * MS)
    time.ticks.answer(100 * MS)
    assert time.answers == [(0, False, 0.0), (100, True, 0.1), (200, False, 0.0)]


@pytest.mark.parametrize("missing", ["answers", "odom"])
def test_the_first_answer_waits_for_all_connections_also_while_time_stands_still(time, missing):
    time.connections[missing] = 0
    time.reach(50)
    time.ticks.answer(0)
    assert time.answers == []
    time.connections[missing] = 1
    time.reach(50)
    time.reach(50)
    assert time.answers == [(0, False, 0.0)]


def test_clock_that_was_set_back_is_told_with_both_times(time):
    for now in (900, 1000, 1000, 300):
        time.reach(now)
    assert time.set_back == ["simulated time was set back from 1.0 to 0.3 s"]
