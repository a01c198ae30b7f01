"""A thread that goes on after exceptions."""

import threading

from waiting import DEADLINE

from aro_robocop_goto_as.ros.web.daemon import start_daemon


def test_a_step_that_fails_is_followed_by_the_next_one():
    steps, again = [], threading.Event()

    def step():
        steps.append(len(steps))
        if len(steps) < 3:
            raise TypeError("unexpected")
        again.set()
        threading.Event().wait()

    start_daemon("test", step)
    assert again.wait(DEADLINE)
    assert steps == [0, 1, 2]
