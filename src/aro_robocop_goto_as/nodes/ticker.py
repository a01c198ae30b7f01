"""A rate on ROS time that can be interrupted, and that neither a paused nor a reset clock can block."""

import threading
import time
from typing import Callable

import rospy

from ..simtime import NANOSECONDS
from . import convert

POLL = 0.02  # [s, wall] longest wait between two looks at `interrupted`, so also when simulated time stands still


class Ticker:
    """Ticks at whole multiples of the period of ROS time: 0.1 s, 0.2 s, ... whenever it was started.

    On the simulator's time those are the very steps at which scan and odometry are stamped.
    """

    def __init__(self, period: float, interrupted: Callable[[], bool]) -> None:
        self._period_ns = int(round(period * NANOSECONDS))
        self._interrupted = interrupted
        self._wall = threading.Condition()
        self._next_ns = 0
        self.tick_ns = 0  # time of the last tick
        self.restart()

    def restart(self) -> None:
        """Tick next at the first multiple of the period after now."""
        self._next_ns = (convert.to_ns(rospy.get_rostime()) // self._period_ns + 1) * self._period_ns

    def wait(self) -> bool:
        """Wait for the next tick: True; or until `interrupted` says so: False."""
        simulated = not rospy.rostime.is_wallclock()
        condition = rospy.rostime.get_rostime_cond() if simulated else self._wall
        with condition:
            while not self._interrupted():
                now = convert.to_ns(rospy.get_rostime())
                if now >= self._next_ns:
                    self.tick_ns = self._next_ns + (now - self._next_ns) // self._period_ns * self._period_ns
                    self._next_ns = self.tick_ns + self._period_ns
                    return True
                if self._next_ns - now > self._period_ns:  # the clock was set back
                    self._next_ns = (now // self._period_ns + 1) * self._period_ns
                remaining = (self._next_ns - now) / NANOSECONDS
                condition.wait(POLL if simulated else min(POLL, remaining))
        return False


def wait_until(condition: Callable[[], bool], timeout: float, poll: float = 0.01) -> bool:
    """Whether a condition came true within `timeout` [s] of wall time, which goes on when simulated time does not."""
    deadline = time.monotonic() + timeout
    while not condition():
        if time.monotonic() >= deadline or rospy.is_shutdown():
            return condition()
        time.sleep(poll)
    return True
