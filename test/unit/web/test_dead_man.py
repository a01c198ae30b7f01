"""When a robot that is driven from the page moves, and when it stops."""

import math

from hypothesis import given
from hypothesis import strategies as st

from aro_robocop_goto_as.geometry import STANDSTILL, Twist2D
from aro_robocop_goto_as.web.dead_man import TIMEOUT, DeadMan, Drive

FORWARD = Twist2D(0.2, 0.0)


def test_the_robot_drives_while_requests_are_renewed_and_is_stopped_once_when_they_end() -> None:
    dead_man = DeadMan()
    for now in (0.0, 0.1, 0.2):
        dead_man.request(1, "red", FORWARD, now)
        assert dead_man.command(now) == Drive("red", FORWARD)
    assert dead_man.command(0.2 + 0.99 * TIMEOUT) == Drive("red", FORWARD)
    assert dead_man.command(0.2 + 1.01 * TIMEOUT) == Drive("red", STANDSTILL)
    assert dead_man.command(0.6) is None and not dead_man.active


def test_a_release_stops_the_robot_at_once() -> None:
    dead_man = DeadMan()
    dead_man.request(1, "", FORWARD, 0.0)
    dead_man.command(0.0)
    dead_man.release(1)
    assert dead_man.active
    assert dead_man.command(0.01) == Drive("", STANDSTILL)
    assert dead_man.command(0.02) is None


def test_a_page_that_goes_does_not_stop_the_robot_that_another_one_drives() -> None:
    dead_man = DeadMan()
    dead_man.request(1, "", FORWARD, 0.0)
    dead_man.request(2, "", FORWARD, 0.1)
    dead_man.release(1)
    assert dead_man.command(0.1) == Drive("", FORWARD)


def test_whoever_presses_stop_stops_the_robot_of_another_page() -> None:
    dead_man = DeadMan()
    dead_man.request(1, "", FORWARD, 0.0)
    dead_man.command(0.0)
    dead_man.stop()
    assert dead_man.command(0.01) == Drive("", STANDSTILL)


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
def test_no_command_but_zero_is_sent_later_than_the_timeout_after_the_last_request(steps: "list") -> None:
    dead_man, now, asked = DeadMan(), 0.0, -math.inf
    for wait, what in steps:
        now += wait
        if what == "request":
            dead_man.request(1, "", FORWARD, now)
            asked = now
        elif what == "release":
            dead_man.release(1)
            asked = -math.inf
        elif what == "stop":
            dead_man.stop()
            asked = -math.inf
        command = dead_man.command(now)
        assert (command == Drive("", FORWARD)) == (now < asked + TIMEOUT)
