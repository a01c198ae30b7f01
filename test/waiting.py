"""Waiting for a condition, with a deadline that only a failure reaches."""

import time

DEADLINE = 120.0  # [s, wall] for any one condition, long enough for a busy machine
POLL = 0.05  # [s, wall]


def wait_for(condition, what, deadline=DEADLINE):
    """The first true value of `condition`; AssertionError naming `what` after `deadline` [s]."""
    until = time.monotonic() + deadline
    while True:
        value = condition()
        if value:
            return value
        assert time.monotonic() < until, f"not within {deadline:g} s: {what}"
        time.sleep(POLL)
