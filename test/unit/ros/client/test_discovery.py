"""What a client says of a server that is not there."""

import pytest
import rospy

from aro_robocop_goto_as.names import ACTION, ACTION_TYPE
from aro_robocop_goto_as.ros import graph
from aro_robocop_goto_as.ros.client import discovery


def unanswered():
    raise OSError


@pytest.mark.parametrize(
    "servers, hint",
    [
        (lambda: {}, ""),
        (lambda: {f"/{ACTION}": ACTION_TYPE, "/fibonacci": "actionlib_tutorials/FibonacciAction"}, ""),
        (lambda: {"/goto": ACTION_TYPE}, "; there is '/goto' of the same type: a misspelt name?"),
        (
            lambda: {f"/blue/{ACTION}": ACTION_TYPE, f"/red/{ACTION}": ACTION_TYPE},
            f"; there is '/blue/{ACTION}' and '/red/{ACTION}' of the same type: which robot is meant?",
        ),
        (unanswered, "; the ROS master does not answer"),
    ],
)
def test_other_servers_of_the_same_type_are_named(monkeypatch, servers, hint):
    monkeypatch.setattr(graph, "action_servers", servers)
    assert discovery.absence(ACTION) == f"waiting for {ACTION}{hint}"


def test_the_robot_whose_name_is_similar_is_suggested(monkeypatch):
    monkeypatch.setattr(
        graph, "action_servers", lambda: {f"/blue/{ACTION}": ACTION_TYPE, f"/red/{ACTION}": ACTION_TYPE}
    )
    assert discovery.absence(f"/rde/{ACTION}").endswith(" of the same type; did you mean red?")


@pytest.mark.parametrize("now, up", [(0, False), (5, True)])
def test_server_can_be_up_from_the_first_message_on_clock_on(monkeypatch, now, up):
    monkeypatch.setattr(rospy, "get_rostime", lambda: rospy.Time(now))

    class Client:
        def wait_for_server(self, timeout):
            """As actionlib's, of a server that is connected."""
            return rospy.get_rostime() + timeout < rospy.get_rostime()

    assert discovery.is_up(Client()) == up
