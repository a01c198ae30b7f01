"""How a goal from the command line is followed: its progress, its end, and what the exit status says."""

import itertools

import pytest
from actionlib import CommState
from actionlib_msgs.msg import GoalStatus
from aro_robocop_goto_as.msg import GoToPositionFeedback, GoToPositionResult
from geometry_msgs.msg import Point
from nav_msgs.msg import Odometry

from aro_robocop_goto_as.ros.cli import followed_goal
from aro_robocop_goto_as.ros.cli.goto_arguments import NOT_REACHED, REACHED


class Client:
    """Stands for SimpleActionClient and its goal's handle; what happens on each look at the server is scripted."""

    def __init__(self, *looks):
        self.looks, self.state, self.text, self.gh = list(looks), CommState.PENDING, "", self

    def send_goal(self, goal, feedback_cb):
        self.feed = lambda text: feedback_cb(GoToPositionFeedback(1.0, 0.5, text))

    def get_comm_state(self):
        return self.state

    def get_goal_status(self):
        return self.status

    def get_goal_status_text(self):
        return self.text

    def get_result(self):
        return self.result

    def end(self, status, success, message, text=""):
        self.status, self.result, self.text = status, GoToPositionResult(success, message), text
        self.state = CommState.DONE

    def cancel_goal(self):
        self.end(GoalStatus.PREEMPTED, False, "PREEMPTED: it was cancelled")


@pytest.fixture
def follow(monkeypatch):
    """Follow a goal of this client; returns the exit status."""

    def follow(client, odom=None):
        follower = followed_goal.Follower.__new__(followed_goal.Follower)
        follower.client, follower.cmd_vel, follower.odom, follower.phase = client, "/cmd_vel", odom, ""
        monkeypatch.setattr(followed_goal, "POLL", 0.0)
        monkeypatch.setattr(followed_goal.discovery, "is_up", lambda _: client.looks.pop(0)() is not False)
        return follower.follow(Point())

    return follow


@pytest.mark.parametrize(
    "ended, status, line",
    [
        ((GoalStatus.SUCCEEDED, True, "REACHED: so"), REACHED, "SUCCEEDED: REACHED: so"),
        ((GoalStatus.ABORTED, False, "OBSTACLE: so"), NOT_REACHED, "ABORTED: OBSTACLE: so"),
        ((GoalStatus.ABORTED, False, "", "Exception in execute callback: 1"), NOT_REACHED, "ABORTED: Exception in "),
        ((GoalStatus.SUCCEEDED, False, ""), NOT_REACHED, "SUCCEEDED"),
    ],
)
def test_exit_status_is_the_success_of_the_result_and_the_last_line_tells_it(follow, capsys, ended, status, line):
    client = Client(lambda: client.end(*ended))
    assert follow(client) == status
    assert capsys.readouterr().out.splitlines()[-1].startswith(line)


def test_a_server_that_is_gone_ends_it(follow, capsys):
    assert follow(Client(lambda: False)) == NOT_REACHED
    assert "the server is gone" in capsys.readouterr().err


def test_an_interrupt_cancels_the_goal_and_its_end_is_told(follow, capsys):
    def interrupt():
        raise KeyboardInterrupt

    assert follow(Client(interrupt)) == NOT_REACHED
    assert "PREEMPTED: it was cancelled" in capsys.readouterr().out


def test_what_a_half_done_server_lacks_is_told_once(follow, monkeypatch, capsys):
    clock = itertools.count(0, 6)
    monkeypatch.setattr(followed_goal.time, "monotonic", lambda: next(clock))
    monkeypatch.setattr(followed_goal.graph, "published_topics", list)
    monkeypatch.setattr(followed_goal.rospy, "resolve_name", str)
    client = Client(*[lambda: None] * 3, lambda: client.end(GoalStatus.ABORTED, False, ""))
    follow(client, Odometry())
    told = "no feedback; nobody publishes /cmd_vel; the robot has not moved"
    assert capsys.readouterr().err == f"robocop goto: after 5 s: {told}\n"
