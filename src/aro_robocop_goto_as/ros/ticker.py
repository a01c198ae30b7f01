"""Waiting in ROS time and in wall time, without being blocked by a paused or reset clock."""

import threading
import time
from typing import Callable

import rospy

from ..simulation.clock import NANOSECONDS
from . import convert, private_api

POLL = 0.02  # [s, wall] the longest time between two calls of `interrupted`, also while /clock is paused


class Ticker:
    """An interruptible rate: ticks at whole multiples of its period of ROS time, 0.1 s, 0.2 s, ...

    On simulated time those are the steps at which scan and odometry are stamped.
    """

    def __init__(self, period: float, interrupted: Callable[[], bool]) -> None:
        self._period_ns = int(round(period * NANOSECONDS))
        self._interrupted = interrupted
        self._wall = threading.Condition()
        self._next_ns = self._first_after(convert.to_ns(rospy.get_rostime()))
        self.tick_ns = 0  # time of the last tick

    def _first_after(self, now_ns: int) -> int:
        return (now_ns // self._period_ns + 1) * self._period_ns

    def wait(self) -> bool:
        """Wait for the next tick; False when `interrupted` returned true before it."""
        clock = private_api.clock_condition()
        condition = clock or self._wall
        with condition:
            while not self._interrupted():
                now = convert.to_ns(rospy.get_rostime())
                if now >= self._next_ns:
                    self.tick_ns = self._next_ns + (now - self._next_ns) // self._period_ns * self._period_ns
                    self._next_ns = self.tick_ns + self._period_ns
                    return True
                if self._next_ns - now > self._period_ns:  # the clock was set back
                    self._next_ns = self._first_after(now)
                remaining = (self._next_ns - now) / NANOSECONDS
                condition.wait(POLL if clock else min(POLL, remaining))
        return False


def wait_until(condition: Callable[[], bool], timeout: float, poll: float = 0.01) -> bool:
    """Whether a condition became true within `timeout` [s, wall], which passes also while /clock is paused."""
    deadline = time.monotonic() + timeout
    while not condition():
        if time.monotonic() >= deadline or rospy.is_shutdown():
            return condition()
        time.sleep(poll)
    return True
