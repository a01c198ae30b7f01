"""A timer goes on after an exception in its callback, also when the clock is set back."""

import pytest
import rospy

from aro_robocop_goto_as.ros.timer import start_timer


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
