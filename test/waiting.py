"""Waiting for a condition, with a deadline that only a failure reaches."""

import time

DEADLINE = 120.0  # [s, wall] for any one condition, long enough for a busy machine
POLL = 0.05  # [s, wall]


def wait_for(condition, what, deadline=DEADLINE, poll=POLL, error=AssertionError, given_up=lambda: False):
    """The first true value of `condition`, which is looked at every `poll` [s].

    After `deadline` [s], or once `given_up` is true, `error` with `what`, which may be callable.
    """
    until = time.monotonic() + deadline
    while True:
        value = condition()
        if value:
            return value
        if time.monotonic() > until or given_up():
            raise error(f"not within {deadline:g} s: {what() if callable(what) else what}")
        time.sleep(poll)
