"""What the web page's node makes of the ROS master's state: the robots, and whether the master knows the node."""

import pytest

from aro_robocop_goto_as.errors import MasterError
from aro_robocop_goto_as.ros.web import master_watch as watch
from aro_robocop_goto_as.web.state import PageState, SharedState

NAME = "/robocop_web"
OURS = [f"{NAME}/get_loggers", [NAME]]
TYPES = [["/odom", watch.ODOMETRY], ["/red/odom", watch.ODOMETRY], ["/blue/odom", "std_msgs/String"]]
PUBLISHERS = [["/odom", ["/sim"]], ["/red/odom", ["/sim"]], ["/blue/odom", ["/other"]], ["/scan", ["/sim"]]]


@pytest.fixture
def look(monkeypatch):
    """One look at a master with these answers."""
    monkeypatch.setattr(watch.rospy, "get_name", lambda: NAME)

    def look(state, registered=True):
        def ask(_uri, request):
            if isinstance(state, Exception):
                raise state
            return TYPES if request == "getTopicTypes" else state

        monkeypatch.setattr(watch.master, "ask_master", ask)
        page = SharedState(PageState(registered=registered))
        problem = watch.look(page)
        return page.now.robots, page.now.forgotten, problem

    return look


def test_robots_are_the_namespaces_of_published_odometry(look):
    assert look([PUBLISHERS, [], [OURS]]) == (("", "red"), False, "")


def test_a_master_that_knows_only_what_was_subscribed_to_later_has_forgotten_the_node(look):
    _, forgotten, problem = look([PUBLISHERS, [["/tf", [NAME]]], []])
    assert forgotten and "was restarted" in problem


def test_a_node_that_is_not_registered_yet_is_not_forgotten(look):
    _, forgotten, problem = look([[], [], []], registered=False)
    assert not forgotten and problem == ""


@pytest.mark.parametrize("error", [MasterError("it hangs"), ConnectionRefusedError()])
def test_a_master_that_does_not_answer_is_a_problem_and_not_a_restart(look, error):
    _, forgotten, problem = look(error)
    assert problem and not forgotten
