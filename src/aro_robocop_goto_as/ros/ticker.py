"""Waiting in wall time, and timers in ROS time: neither a paused clock nor one that is set back stops them."""

import time
import traceback
from typing import Callable, TypeVar

import rospy

T = TypeVar("T")


def wait_until(condition: Callable[[], T], timeout: float, poll: float = 0.01) -> T:
    """The first true value of a condition, else its last one after `timeout` [s, wall] or on shutdown.

    Wall time passes also while /clock is paused.
    """
    deadline = time.monotonic() + timeout
    while True:
        value = condition()
        if value or time.monotonic() >= deadline or rospy.is_shutdown():
            return value
        time.sleep(poll)


def start_timer(period: float, callback: Callable[[], None]) -> rospy.Timer:
    """Call `callback` every `period` [s] of ROS time; exceptions are logged, at most once in ten seconds."""

    def guarded(_event: rospy.timer.TimerEvent) -> None:
        try:
            callback()
        except rospy.ROSException as error:  # publishing on a topic that shutdown has closed
            rospy.logdebug("timer callback: %s", error)
        except Exception:  # the timer thread's outermost level: rospy would end the thread silently
            if not rospy.is_shutdown():
                rospy.logerr_throttle(10.0, "timer callback failed, the timer continues:\n%s", traceback.format_exc())

    return rospy.Timer(rospy.Duration.from_sec(period), guarded, reset=True)
