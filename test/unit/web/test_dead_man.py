"""When a robot that is driven from the page moves, and when it stops."""

import pytest

from aro_robocop_goto_as.geometry import STANDSTILL, Twist2D
from aro_robocop_goto_as.web.dead_man import TIMEOUT, DeadMan, Drive

FORWARD = Twist2D(0.2, 0.0)


def test_the_robot_drives_while_requests_are_renewed_and_is_stopped_once_when_they_end():
    dead_man = DeadMan()
    for now in (0.0, 0.1, 0.2):
        dead_man.request(1, "red", FORWARD, now)
        assert dead_man.command(now) == Drive("red", FORWARD)
    assert dead_man.command(0.2 + 0.99 * TIMEOUT) == Drive("red", FORWARD)
    assert dead_man.command(0.2 + 1.01 * TIMEOUT) == Drive("red", STANDSTILL)
    assert dead_man.command(0.6) is None and not dead_man.active


@pytest.mark.parametrize("end", [lambda dead_man: dead_man.release(1), DeadMan.stop], ids=["release", "stop"])
def test_a_release_or_a_stop_of_any_page_stops_the_robot_at_once_and_once(end):
    dead_man = DeadMan()
    dead_man.request(1, "", FORWARD, 0.0)
    dead_man.command(0.0)
    end(dead_man)
    assert dead_man.active
    assert [dead_man.command(0.01), dead_man.command(0.02)] == [Drive("", STANDSTILL), None]


def test_a_page_that_goes_does_not_stop_the_robot_that_another_one_drives():
    dead_man = DeadMan()
    dead_man.request(1, "", FORWARD, 0.0)
    dead_man.request(2, "", FORWARD, 0.1)
    dead_man.release(1)
    assert dead_man.command(0.1) == Drive("", FORWARD)


def test_the_former_robot_is_stopped_before_the_next_one_drives():
    dead_man = DeadMan()
    dead_man.request(1, "red", FORWARD, 0.0)
    dead_man.command(0.0)
    dead_man.request(1, "blue", FORWARD, 0.1)
    assert dead_man.command(0.1) == Drive("red", STANDSTILL)
    assert dead_man.command(0.1) == Drive("blue", FORWARD)


def test_only_the_first_request_of_a_robot_begins_a_drive():
    dead_man, requests = DeadMan(), (("red", 0.0), ("red", 0.1), ("red", 0.2), ("red", 0.6), ("blue", 0.7))
    begins = [dead_man.request(1, robot, FORWARD, now) for robot, now in requests]
    assert begins == [True, False, False, True, True]
