"""What a client says of a server that is not there."""

import pytest
import rospy

from aro_robocop_goto_as.names import ACTION, ACTION_TYPE
from aro_robocop_goto_as.ros import graph
from aro_robocop_goto_as.ros.client import discovery


def unanswered():
    raise OSError


def of_two_robots():
    return {f"/blue/{ACTION}": ACTION_TYPE, f"/red/{ACTION}": ACTION_TYPE}


BOTH = f"; there is '/blue/{ACTION}' and '/red/{ACTION}' of the same type"


@pytest.mark.parametrize(
    "servers, action, hint",
    [
        (lambda: {}, ACTION, ""),
        (lambda: {f"/{ACTION}": ACTION_TYPE, "/fibonacci": "actionlib_tutorials/FibonacciAction"}, ACTION, ""),
        (lambda: {"/goto": ACTION_TYPE}, ACTION, "; there is '/goto' of the same type: a misspelt name?"),
        (of_two_robots, ACTION, f"{BOTH}: which robot is meant?"),
        (of_two_robots, f"/rde/{ACTION}", f"{BOTH}; did you mean red?"),
        (unanswered, ACTION, "; the ROS master does not answer"),
    ],
)
def test_other_servers_of_the_same_type_are_named_and_the_robot_of_a_similar_name(monkeypatch, servers, action, hint):
    monkeypatch.setattr(graph, "action_servers", servers)
    assert discovery.absence(action) == f"waiting for {action}{hint}"
    choice = " --robot NAME chooses it" if "which robot" in hint else ""
    assert discovery.hint(action, " --robot NAME chooses it") == hint + choice


@pytest.mark.parametrize("now, up", [(0, False), (5, True)])
def test_server_can_be_up_from_the_first_message_on_clock_on(monkeypatch, now, up):
    monkeypatch.setattr(rospy, "get_rostime", lambda: rospy.Time(now))

    class Client:
        def wait_for_server(self, timeout):
            """As actionlib's, of a server that is connected."""
            return rospy.get_rostime() + timeout < rospy.get_rostime()

    assert discovery.is_up(Client()) == up
