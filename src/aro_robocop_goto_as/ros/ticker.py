"""Waiting in ROS time and in wall time, and timers: neither a paused clock nor one that is set back stops them."""

import threading
import time
import traceback
from typing import Callable, TypeVar

import rospy

from ..simulation.schedule import NANOSECONDS
from . import convert
from .rospy_internals import clock_condition

POLL = 0.02  # [s, wall] the longest time between two calls of `interrupted`, also while /clock is paused
T = TypeVar("T")


def _ros_time_ns() -> int:
    return convert.to_ns(rospy.get_rostime())


class Ticker:
    """An interruptible rate: ticks at whole multiples of its period of ROS time, 0.1 s, 0.2 s, ...

    On simulated time those are the steps at which scan and odometry are stamped.
    """

    def __init__(
        self, period: float, interrupted: Callable[[], bool], now_ns: Callable[[], int] = _ros_time_ns
    ) -> None:
        """`period` [s]; `now_ns` is the clock [ns]."""
        self._period_ns = int(round(period * NANOSECONDS))
        self._interrupted = interrupted
        self._wall = threading.Condition()
        self._now_ns = now_ns
        self._next_ns = self._first_after(now_ns())
        self.tick_ns = 0  # time of the last tick

    def _first_after(self, now_ns: int) -> int:
        return (now_ns // self._period_ns + 1) * self._period_ns

    def _first_of_new_time(self, now_ns: int) -> int:
        """The clock was set back, and may already show a tick, as it went on before it was looked at; 0 is none."""
        return max(self._period_ns, self._first_after(now_ns - 1))

    def wait(self) -> bool:
        """Wait for the next tick; False when `interrupted` returned true before it."""
        clock = clock_condition()
        condition = clock or self._wall
        with condition:
            while not self._interrupted():
                now = self._now_ns()
                if self._next_ns - now > self._period_ns:
                    self._next_ns = self._first_of_new_time(now)
                if now >= self._next_ns:
                    self.tick_ns = self._next_ns + (now - self._next_ns) // self._period_ns * self._period_ns
                    self._next_ns = self.tick_ns + self._period_ns
                    return True
                remaining = (self._next_ns - now) / NANOSECONDS
                condition.wait(POLL if clock else min(POLL, remaining))
        return False


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
