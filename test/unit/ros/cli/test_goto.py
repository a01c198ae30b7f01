"""The arguments of robocop goto, the progress and the end of its goal, and what the exit status says."""

import argparse
import itertools
import re

import pytest
from aro_robocop_goto_as.msg import GoToPositionFeedback
from geometry_msgs.msg import Point
from nav_msgs.msg import Odometry

from aro_robocop_goto_as.cli.commands import HELP
from aro_robocop_goto_as.ros.cli import goto
from aro_robocop_goto_as.ros.cli.goto import NOT_REACHED, REACHED, parse


@pytest.mark.parametrize("x", ["1e9", "-1e9", "nan", "inf", "one", ""])
def test_coordinates_that_are_no_place_end_the_program_with_2(x, capsys):
    with pytest.raises(SystemExit) as refused:
        parse([x, "0"])
    assert refused.value.code == 2
    assert "expected a number of metres within +-1e+06" in capsys.readouterr().err


def test_negative_numbers_are_coordinates():
    args = parse(["-5e-1", "-2"])
    assert (args.x, args.y, args.frame) == (-0.5, -2.0, "map")


def test_only_a_missing_coordinate_is_called_missing(capsys):
    with pytest.raises(SystemExit):
        parse(["0.3"])
    assert "the following arguments are required: Y\n" in capsys.readouterr().err


def test_each_option_is_in_the_help_that_needs_nothing_installed(capsys):
    with pytest.raises(SystemExit):
        parse(["--help"])
    options = set(re.findall(r"--[a-z]+", capsys.readouterr().out)) - {"--help"}
    assert options and options <= set(re.findall(r"--[a-z]+", HELP.read_text()))


class GoalFollower:
    """Stands for the follower of a goal; what happens on each look at the server is scripted."""

    def __init__(self, *looks):
        self.looks, self.ending, self.reached, self.cancelled = list(looks), "", False, False

    def send(self, position):
        pass

    def is_up(self):
        return self.looks.pop(0)() is not False

    def has_ended(self):
        return bool(self.ending)

    def state(self):
        return self.ending

    def is_reached(self):
        return self.reached

    def end(self, ending, reached=False):
        self.ending, self.reached = ending, reached

    def cancel(self, timeout):
        self.end("PREEMPTED: it was cancelled")


@pytest.fixture
def made(monkeypatch):
    """Make the goal of a command line with this follower, of a robot with this odometry."""

    def make(follower, odom=None):
        monkeypatch.setattr(goto, "POLL", 0.0)
        monkeypatch.setattr(goto, "GoalFollower", lambda *_: follower)
        monkeypatch.setattr(goto, "GoalTransformer", lambda *_: None)
        monkeypatch.setattr(goto.rospy, "Subscriber", lambda *_, **__: None)
        goal = goto.Goto(argparse.Namespace(robot="", x=1.0, y=0.0, frame="map"))
        goal.odom = odom
        return goal

    return make


@pytest.mark.parametrize("reached, status", [(True, REACHED), (False, NOT_REACHED)])
def test_exit_status_is_the_success_of_the_result_and_the_last_line_tells_it(made, capsys, reached, status):
    follower = GoalFollower(lambda: follower.end("SUCCEEDED: so", reached))
    assert made(follower).follow(Point()) == status
    assert capsys.readouterr().out == "SUCCEEDED: so\n"


def test_a_server_that_is_gone_ends_it(made, capsys):
    assert made(GoalFollower(lambda: False)).follow(Point()) == NOT_REACHED
    assert "the server is gone" in capsys.readouterr().err


def interrupt():
    raise KeyboardInterrupt


def test_an_interrupt_cancels_the_goal_and_its_end_is_told(made, capsys):
    assert made(GoalFollower(interrupt)).follow(Point()) == NOT_REACHED
    assert capsys.readouterr().out == "PREEMPTED: it was cancelled\n"


def test_an_interrupt_while_the_goal_is_sent_cancels_it(made, capsys):
    follower = GoalFollower()
    follower.send = lambda position: interrupt()  # as Deferred raises it once the goal is sent
    assert made(follower).follow(Point()) == NOT_REACHED
    assert capsys.readouterr().out == "PREEMPTED: it was cancelled\n"


def test_each_phase_is_shown_once(made, capsys):
    goal = made(GoalFollower())
    for text in ("rotating, 0.50 rad to go", "rotating, 0.40 rad to go", "driving, 1.00 m to go"):
        goal.show(GoToPositionFeedback(1.0, 0.5, text))
    assert [line.split("rad   ")[1][:8] for line in capsys.readouterr().out.splitlines()] == ["rotating", "driving,"]


def test_what_a_half_done_server_lacks_is_told_once(made, monkeypatch, capsys):
    clock = itertools.count(0, 6)
    monkeypatch.setattr(goto.time, "monotonic", lambda: next(clock))
    monkeypatch.setattr(goto.graph, "published_topics", list)
    monkeypatch.setattr(goto.rospy, "resolve_name", str)
    follower = GoalFollower(*[lambda: None] * 3, lambda: follower.end("ABORTED"))
    made(follower, Odometry()).follow(Point())
    told = "no feedback; nobody publishes cmd_vel; the robot has not moved"
    assert capsys.readouterr().err == f"robocop goto: after 5 s: {told}\n"
