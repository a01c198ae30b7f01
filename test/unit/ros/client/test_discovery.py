"""What a client says of a server that is not there."""

import pytest

from aro_robocop_goto_as.ros import graph
from aro_robocop_goto_as.ros.client import discovery
from aro_robocop_goto_as.ros.names import ACTION, ACTION_TYPE


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


@pytest.mark.parametrize("lives, looks", [(False, 1), (True, 3)])
def test_server_that_lives_and_has_not_connected_yet_gets_more_time(monkeypatch, lives, looks):
    waits = []
    monkeypatch.setattr(discovery, "is_up", lambda _client: len(waits) == 3)
    monkeypatch.setattr(discovery, "wait_until", lambda condition, _timeout: waits.append(1) or condition())
    monkeypatch.setattr(graph, "has_living_publisher", lambda topic: lives and topic == f"/{ACTION}/result")
    monkeypatch.setattr(graph, "action_servers", dict)
    missing = discovery.wait_or_explain(None, f"/{ACTION}", 5.0, lambda: False)
    assert (missing == "", len(waits)) == (lives, looks)
