"""Ticks are whole multiples of the period, whatever the clock does; a timer goes on after an exception."""

import itertools

import pytest
import rospy

from aro_robocop_goto_as.ros.ticker import Ticker, start_timer, wait_until

MS = 1_000_000  # [ns]


def ticks(*times, interrupted=lambda: False):
    """The times [ms] of ticks with a period of 100 ms, by a clock that shows these times [ms] and then the last one."""
    clock = itertools.chain(times, itertools.repeat(times[-1]))
    end = iter(times)

    def over():
        return interrupted() or next(end, None) is None

    ticker = Ticker(0.1, over, lambda: next(clock) * MS)
    found = []
    while ticker.wait():
        found.append(ticker.tick_ns // MS)
    return found


def test_ticks_are_the_next_multiples_of_the_period():
    assert ticks(30, 60, 99, 100, 140, 200) == [100, 200]


def test_ticks_that_were_missed_are_left_out():
    assert ticks(30, 100, 475, 480, 501) == [100, 400, 500]


def test_after_a_clock_was_set_back_the_ticks_are_those_of_the_new_time():
    assert ticks(930, 1000, 20, 60, 110) == [1000, 100]


def test_clock_that_was_set_back_and_went_on_to_a_tick_before_it_was_looked_at_shows_that_tick():
    assert ticks(930, 1000, 100, 200) == [1000, 100, 200]
    assert ticks(930, 1000, 0, 100) == [1000, 100]


def test_a_request_ends_the_wait_without_a_tick():
    assert ticks(30, 40, 100, interrupted=lambda: True) == []


def test_wait_until_says_whether_the_condition_became_true():
    answers = iter([False, False, True])
    assert wait_until(lambda: next(answers), 10.0, 0.0)
    assert not wait_until(lambda: False, 0.0)


@pytest.mark.parametrize(
    "error, logged", [(rospy.ROSException("publish() to a closed topic"), 0), (ValueError("a bug"), 2)]
)
def test_exception_in_the_callback_does_not_end_the_timer(monkeypatch, error, logged):
    timers, calls, log = [], [], []
    monkeypatch.setattr(rospy, "logerr_throttle", lambda *arguments: log.append(arguments))
    monkeypatch.setattr(rospy, "Timer", lambda *arguments, **options: timers.append((*arguments, options)))

    def fail():
        calls.append(1)
        raise error

    start_timer(0.5, fail)
    ((period, callback, options),) = timers
    assert (period.to_sec(), options) == (0.5, {"reset": True})
    callback(None)
    callback(None)
    assert (len(calls), len(log)) == (2, logged)
