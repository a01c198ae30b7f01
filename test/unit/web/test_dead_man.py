"""When a robot that is driven from the page moves, and when it stops."""

import math

from hypothesis import given
from hypothesis import strategies as st

from aro_robocop_goto_as.geometry import STANDSTILL, Twist2D
from aro_robocop_goto_as.web.dead_man import TIMEOUT, DeadMan, Drive

FORWARD = Twist2D(0.2, 0.0)


def test_a_page_that_goes_does_not_stop_the_robot_that_another_one_drives() -> None:
    dead_man = DeadMan()
    dead_man.request(1, "", FORWARD, 0.0)
    dead_man.request(2, "", FORWARD, 0.1)
    dead_man.release(1)
    assert dead_man.command(0.1) == Drive("", FORWARD)


def test_the_former_robot_is_stopped_before_the_next_one_drives() -> None:
    dead_man = DeadMan()
    dead_man.request(1, "red", FORWARD, 0.0)
    dead_man.command(0.0)
    dead_man.request(1, "blue", FORWARD, 0.1)
    assert dead_man.command(0.1) == Drive("red", STANDSTILL)
    assert dead_man.command(0.1) == Drive("blue", FORWARD)


def test_only_the_first_request_begins_a_drive() -> None:
    dead_man = DeadMan()
    begins = [dead_man.request(1, "", FORWARD, now) for now in (0.0, 0.1, 0.2, 0.6)]
    assert begins == [True, False, False, True]


@given(st.lists(st.tuples(st.floats(0.0, 0.5), st.sampled_from(["request", "release", "stop", "tick"])), max_size=40))
def test_the_robot_drives_while_requests_are_renewed_and_is_stopped_once_when_they_end(steps: "list") -> None:
    dead_man, now, asked, moves = DeadMan(), 0.0, -math.inf, False
    for wait, what in steps:
        now += wait
        if what == "request":
            dead_man.request(1, "red", FORWARD, now)
        elif what == "release":
            dead_man.release(1)
        elif what == "stop":
            dead_man.stop()
        asked = now if what == "request" else asked if what == "tick" else -math.inf
        wanted = now < asked + TIMEOUT
        stopped = Drive("red", STANDSTILL) if moves else None
        assert dead_man.command(now) == (Drive("red", FORWARD) if wanted else stopped)
        assert dead_man.active is wanted
        moves = wanted
