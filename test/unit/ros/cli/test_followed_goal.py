"""How a goal from the command line is followed: its progress, its end, and what the exit status says."""

import pytest
import rospy
from actionlib import CommState
from actionlib_msgs.msg import GoalStatus
from aro_robocop_goto_as.msg import GoToPositionFeedback, GoToPositionResult
from geometry_msgs.msg import Point

from aro_robocop_goto_as.ros.cli import followed_goal
from aro_robocop_goto_as.ros.cli.goto_arguments import NOT_REACHED, REACHED


class Server:
    """Stands for the client, its goal's handle and the server; what happens on each look at the server is scripted."""

    def __init__(self, monkeypatch, *looks):
        self.looks, self.cancelled, self.state = list(looks), False, CommState.PENDING
        monkeypatch.setattr(rospy, "get_rostime", lambda: rospy.Time(5))
        monkeypatch.setattr(followed_goal.discovery, "is_up", lambda client: self.look())

    def look(self):
        return self.looks.pop(0)() is not False

    def send_goal(self, goal, on_transition, on_feedback):
        self.on_transition, self.on_feedback = on_transition, on_feedback
        self.looks.pop(0)()
        return self

    def get_comm_state(self):
        return self.state

    def get_goal_status(self):
        return self.ended[0]

    def get_result(self):
        return self.ended[1]

    def end(self, status, success, message):
        self.ended, self.state = (status, GoToPositionResult(success, message)), CommState.DONE
        self.on_transition(self)

    def reach(self):
        self.end(GoalStatus.SUCCEEDED, True, "REACHED: so")

    def feed(self, message):
        self.on_feedback(self, GoToPositionFeedback(1.0, 0.5, message))

    def cancel(self):
        self.cancelled = True
        self.end(GoalStatus.PREEMPTED, False, "PREEMPTED: it was cancelled")


@pytest.mark.parametrize(
    "ended, status, line",
    [
        ((GoalStatus.SUCCEEDED, True, "REACHED: so"), REACHED, "SUCCEEDED: REACHED: so"),
        ((GoalStatus.ABORTED, False, "OBSTACLE: so"), NOT_REACHED, "ABORTED: OBSTACLE: so"),
        ((GoalStatus.SUCCEEDED, False, ""), NOT_REACHED, "SUCCEEDED"),
    ],
)
def test_exit_status_is_the_success_of_the_result_and_the_last_line_tells_it(monkeypatch, capsys, ended, status, line):
    server = Server(monkeypatch, lambda: None, lambda: server.end(*ended))
    assert followed_goal.follow(server, Point()) == status
    assert capsys.readouterr().out.splitlines()[-1] == line


def test_a_goal_that_ends_before_it_is_known_to_be_sent_is_reached(monkeypatch):
    server = Server(monkeypatch, lambda: server.reach())
    assert followed_goal.follow(server, Point()) == REACHED


def test_each_phase_is_printed_once_where_output_is_no_terminal(monkeypatch, capsys):
    def drive():
        for message in ("rotating, 0.5 rad to go", "rotating, 0.4 rad to go", "driving, 1.0 m to go"):
            server.feed(message)

    server = Server(monkeypatch, drive, lambda: server.reach())
    followed_goal.follow(server, Point())
    phases = [line.split("rad   ")[1] for line in capsys.readouterr().out.splitlines()[:-1]]
    assert phases == ["rotating, 0.5 rad to go", "driving, 1.0 m to go"]


def test_a_server_that_is_gone_ends_it(monkeypatch, capsys):
    server = Server(monkeypatch, lambda: None, lambda: False)
    assert followed_goal.follow(server, Point()) == NOT_REACHED
    assert "the server is gone" in capsys.readouterr().err


def test_an_interrupt_cancels_the_goal_and_its_end_is_told(monkeypatch, capsys):
    def interrupt():
        raise KeyboardInterrupt

    server = Server(monkeypatch, lambda: None, interrupt)
    assert followed_goal.follow(server, Point()) == NOT_REACHED
    assert server.cancelled and "PREEMPTED: it was cancelled" in capsys.readouterr().out


def test_a_pause_is_told_once(monkeypatch, capsys):
    monkeypatch.setattr(followed_goal, "PAUSE_TIMEOUT", 0.0)
    monkeypatch.setattr(followed_goal, "standstill", lambda: "time stands still")
    server = Server(monkeypatch, *[lambda: None] * 3, lambda: server.reach())
    followed_goal.follow(server, Point())
    assert capsys.readouterr().err.count("time stands still") == 1
