"""What becomes of a goal, as actionlib's client knows it."""

import logging
from types import SimpleNamespace

import actionlib
import pytest
import rospy
from actionlib_msgs.msg import GoalStatus
from aro_robocop_goto_as.msg import GoToPositionResult

from aro_robocop_goto_as.ros.client import goal_follower
from aro_robocop_goto_as.ros.client.goal_follower import GoalFollower, ending


class Client:
    """Stands for SimpleActionClient with a goal in a state."""

    def __init__(self, comm_state, state, result=None, text=""):
        self.gh = SimpleNamespace(get_comm_state=lambda: comm_state)
        self.get_state, self.get_result, self.get_goal_status_text = lambda: state, lambda: result, lambda: text

    def wait_for_server(self, timeout):
        """As actionlib's, of a server that is connected."""
        return rospy.get_rostime() + timeout < rospy.get_rostime()


@pytest.fixture
def follow(monkeypatch):
    """Make a follower with this client."""

    def follow(client):
        monkeypatch.setattr(goal_follower.actionlib, "SimpleActionClient", lambda *_: client)
        return GoalFollower("goto", lambda feedback: None)

    return follow


@pytest.mark.parametrize("now, up", [(0, False), (5, True)])
def test_server_can_be_up_from_the_first_message_on_clock_on(follow, monkeypatch, now, up):
    monkeypatch.setattr(rospy, "get_rostime", lambda: rospy.Time(now))
    assert follow(Client(actionlib.CommState.DONE, GoalStatus.SUCCEEDED)).is_up() == up


@pytest.mark.parametrize(
    "comm_state, state, success, text, shown",
    [
        (actionlib.CommState.ACTIVE, GoalStatus.ACTIVE, None, "", "ACTIVE"),
        (actionlib.CommState.WAITING_FOR_RESULT, GoalStatus.SUCCEEDED, None, "so", "SUCCEEDED"),
        (actionlib.CommState.DONE, GoalStatus.SUCCEEDED, True, "", "SUCCEEDED: REACHED: so"),
        (actionlib.CommState.DONE, GoalStatus.SUCCEEDED, False, "", "SUCCEEDED: REACHED: so"),
        (actionlib.CommState.DONE, GoalStatus.LOST, None, "", "LOST"),
    ],
)
def test_state_is_actionlibs_until_the_result_is_there_and_then_tells_the_end(
    follow, comm_state, state, success, text, shown
):
    result = None if success is None else GoToPositionResult(success, "REACHED: so")
    followed = follow(Client(comm_state, state, result, text))
    assert (followed.state(), followed.has_ended()) == (shown, comm_state == actionlib.CommState.DONE)
    assert followed.is_reached() == bool(success)


@pytest.mark.parametrize(
    "message, text, shown",
    [
        ("", "", "ABORTED"),
        ("STUCK: so", "", "ABORTED: STUCK: so"),
        ("ABORTED: so", "other", "ABORTED: so"),
        ("", "Exception in execute callback: 1", "ABORTED: Exception in execute callback: 1"),
    ],
)
def test_ending_is_the_state_and_the_message_of_the_result_or_else_actionlibs_own_text(message, text, shown):
    assert ending(GoalStatus.ABORTED, message, text) == shown


def test_actionlibs_error_of_a_goal_that_starts_at_once_is_not_logged(follow):
    follow(Client(actionlib.CommState.DONE, GoalStatus.SUCCEEDED))
    log = logging.getLogger("rosout")
    texts = "Got a transition callback on a goal handle that we're not tracking", "Got it"
    passed = [log.filter(log.makeRecord("", logging.ERROR, "", 0, text, (), None)) for text in texts]
    assert list(map(bool, passed)) == [False, True]
