"""Waiting in wall time, which passes also while /clock is paused."""

import time
from typing import Callable, TypeVar

import rospy

T = TypeVar("T")
POLL = 0.01  # [s, wall]


def wait_until(condition: Callable[[], T], timeout: float) -> T:
    """The first true value of a condition, else its last one after `timeout` [s, wall] or on shutdown."""
    deadline = time.monotonic() + timeout
    while True:
        value = condition()
        if value or time.monotonic() >= deadline or rospy.is_shutdown():
            return value
        time.sleep(POLL)
