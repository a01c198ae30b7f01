"""Waiting for a condition; a timer goes on after an exception."""

import pytest
import rospy

from aro_robocop_goto_as.ros.ticker import start_timer, wait_until


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
