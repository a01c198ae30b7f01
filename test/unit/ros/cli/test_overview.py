"""The overview that ./robocop run prints."""

from pathlib import Path
from types import SimpleNamespace

import pytest

from aro_robocop_goto_as.names import COMMAND_VARIABLE, SERVER
from aro_robocop_goto_as.ros.cli.overview import overview
from aro_robocop_goto_as.web import access


def shown(*nodes, arguments=""):
    """The overview's rows for nodes of these names."""
    nodes = [SimpleNamespace(name=name, namespace="/", args="" if name == "rviz" else arguments) for name in nodes]
    text = overview(nodes, {}, Path("/logs"), False)
    return dict((line[:14].strip(), line[14:]) for line in text.splitlines() if line[:1].strip())


@pytest.mark.parametrize(
    "arguments, address",
    [
        ("web_host:= web_port:=", "http://localhost:8080 (from a phone with web_host:=0.0.0.0)"),
        ("web_host:=0.0.0.0 web_port:=8090", "http://192.0.2.7:8090"),
    ],
)
def test_the_address_of_the_web_page_is_shown_if_it_is_started(monkeypatch, arguments, address):
    monkeypatch.setattr(access, "own_address", lambda: "192.0.2.7")
    assert shown("robocop_web", arguments=arguments)["view"] == f"in a browser: {address}"
    assert "view" not in shown("robocop_sim")


def test_a_recording_says_where_it_is_shown_and_that_it_waits_for_a_browser():
    arguments = "web_host:=192.0.2.1 web_port:=8090 replay:='/a.bag'"
    assert shown("replay", arguments=arguments)["view"].startswith("in a browser: http://192.0.2.1:8090; it plays when")
    assert shown("replay", "rviz", arguments=arguments)["view"] == "in a browser: http://192.0.2.1:8090"


def test_goals_are_offered_only_with_a_server():
    assert "send a goal" in shown("aro_robocop_goto_as_node")
    assert "send a goal" not in shown("robocop_sim")


@pytest.mark.parametrize(
    "variables, command",
    [
        ({}, "./robocop"),
        ({"ROS_MASTER_URI": "http://localhost:11311"}, "./robocop"),
        ({"ROS_MASTER_URI": "http://lab:11411"}, "ROS_MASTER_URI=http://lab:11411 ./robocop"),
        ({"ROS_MASTER_URI": "http://lab:11411", COMMAND_VARIABLE: "docker exec it"}, "docker exec it"),
    ],
)
def test_commands_for_a_second_terminal_use_the_master_of_this_one(monkeypatch, variables, command):
    for name in ("ROS_MASTER_URI", COMMAND_VARIABLE):
        monkeypatch.delenv(name, raising=False)
    for name, value in variables.items():
        monkeypatch.setenv(name, value)
    rows = shown(SERVER)
    assert rows["send a goal"].startswith(f"in a second terminal: {command} goto ")
    assert rows["inspect"].startswith(f"in a second terminal: {command} shell, ")


@pytest.mark.parametrize(
    "simulator, words",
    [
        ({}, ["world         stage_4; its pillars stand still, moving:=true starts them\n", "goto 0.3 0\n"]),
        ({"moving": True}, ["obstacles may move into the robot's way, moving:=false stops them", "goto -0.7 -0.6\n"]),
        ({"world": "world"}, ["world         world\n", "goto X Y "]),
        ({"robots": "red 0 0;"}, ["robots        red 0 0 (burger unless named)\n"]),
        ({"odom_tf": False}, ["a bridge that transforms goals needs odom_tf:=true"]),
    ],
)
def test_the_world_and_a_goal_that_can_be_reached_in_it_are_shown(simulator, words):
    server = SimpleNamespace(name=SERVER, namespace="/", args="")
    text = overview([server], simulator, Path("/logs"), False)
    assert [it for it in words if it not in text] == []
    assert ("transforms" in text) is ("odom_tf" in simulator)


def test_a_goal_is_offered_for_the_first_robot_which_rviz_shows():
    servers = [SimpleNamespace(name=SERVER, namespace=f"/{robot}/", args="") for robot in ("red", "blue")]
    assert "goto 0.3 0 --robot red\n" in overview(servers, {}, Path("/logs"), False)


def test_a_hosted_packages_own_messages_are_known_to_a_second_terminal_by_the_line_that_is_shown(monkeypatch):
    monkeypatch.setenv("ROBOCOP_WS", "/own/devel")
    for devel in ("/own/devel", "/with/lab/devel"):
        monkeypatch.setenv("CMAKE_PREFIX_PATH", f"{devel}:/ros")
        text = overview([], {}, Path("/logs"), False)
        assert (f"source {devel}/setup.bash --extend\n" in text) is (devel != "/own/devel")
