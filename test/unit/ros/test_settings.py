"""What ./robocop says about the settings of ROS before it starts anything."""

import pytest
from ros.test_master import ros_master

from aro_robocop_goto_as.ros import graph, settings

REMOVED = "For the lab on this machine: unset "


@pytest.fixture(autouse=True)
def of_a_fresh_terminal(monkeypatch):
    for name in ("ROS_MASTER_URI", "ROS_HOSTNAME", "ROS_IP", "ROBOCOP_COMMAND"):
        monkeypatch.delenv(name, raising=False)


def test_nothing_is_wrong_where_nothing_is_set():
    assert settings.problem() == ""


@pytest.mark.parametrize(
    "uri", ["foo", "http://localhost", "http://localhost:99999", "localhost:11311", "http://:11311"]
)
def test_an_address_that_no_master_can_have_is_refused(monkeypatch, uri):
    monkeypatch.setenv("ROS_MASTER_URI", uri)
    expected = f"ROS_MASTER_URI={uri} is no address of a ROS master; expected http://HOST:PORT. {REMOVED}ROS_MASTER"
    assert settings.problem().startswith(expected)


@pytest.mark.parametrize(
    "variables, unset",
    [
        ({"ROS_MASTER_URI": "http://no-such-robot.invalid:11311"}, "ROS_MASTER_URI "),
        ({"ROS_MASTER_URI": "http://192.0.2.7:9"}, "ROS_MASTER_URI "),  # RFC 5737: an address that nobody has
        ({"ROS_MASTER_URI": "http://192.0.2.7:9", "ROS_IP": "127.0.0.1"}, "ROS_MASTER_URI "),
        ({"ROS_MASTER_URI": "http://192.0.2.7:9", "ROS_HOSTNAME": "192.0.2.20"}, "ROS_MASTER_URI ROS_HOSTNAME "),
        ({"ROS_HOSTNAME": "192.0.2.20", "ROS_IP": "192.0.2.20"}, "ROS_HOSTNAME ROS_IP "),
    ],
)
def test_what_was_set_for_another_network_is_named_with_the_line_that_removes_it(monkeypatch, variables, unset):
    monkeypatch.setattr(graph, "TIMEOUT", 0.3)
    for name, value in variables.items():
        monkeypatch.setenv(name, value)
    assert REMOVED + unset in settings.problem()
    monkeypatch.setenv("ROBOCOP_COMMAND", "docker exec robocop")
    assert f"start it without -e {unset.strip().replace(' ', ' and -e ')}" in settings.problem()


@pytest.fixture
def on_another_machine(monkeypatch):
    """A function that makes a master's address one of another machine."""

    def place(uri):
        monkeypatch.setenv("ROS_MASTER_URI", uri)
        monkeypatch.setattr(settings, "is_own", lambda host: host != "127.0.0.1")

    return place


def test_a_master_of_another_machine_is_used_by_nodes_that_it_can_reach(monkeypatch, on_another_machine):
    with ros_master() as uri:
        on_another_machine(uri)
        assert settings.problem() == ""
        monkeypatch.setenv("ROS_HOSTNAME", "localhost")
        assert settings.problem().startswith(
            "ROS_HOSTNAME=localhost can't be reached by 127.0.0.1, where ROS_MASTER_URI"
        )
