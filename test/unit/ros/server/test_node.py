"""Each goal gets one terminal state, and the robot stops then: with stand-ins for actionlib and the topics."""

import math
import threading
from types import SimpleNamespace

import pytest
import rospy
from aro_robocop_goto_as.msg import GoToPositionGoal
from geometry_msgs.msg import Point
from nav_msgs.msg import Odometry
from rosgraph_msgs.msg import Clock
from sensor_msgs.msg import LaserScan

from aro_robocop_goto_as.goto_params import GotoParams
from aro_robocop_goto_as.ros.server import node, ticks

DEADLINE = 20.0  # [s, wall]


class System:
    """A server whose clock and inputs a test sets, and what its client and robot get."""

    def __init__(self, monkeypatch):
        self.now, self.callbacks, self.speeds, self.feedback, self.ended = rospy.Time(), {}, [], [], []
        self.waits, self.is_cancelled = threading.Event(), False
        topic = SimpleNamespace(resolved_name="/x", get_num_connections=lambda: 1, publish=self.publish)
        monkeypatch.setattr(rospy, "get_param", lambda *_: True)
        monkeypatch.setattr(rospy, "get_rostime", lambda: self.now)
        monkeypatch.setattr(rospy, "Publisher", lambda *_, **__: topic)
        monkeypatch.setattr(rospy, "Subscriber", self.subscribe)
        for name in ("Timer", "on_shutdown", "signal_shutdown"):
            monkeypatch.setattr(rospy, name, lambda *_, **__: None)
        monkeypatch.setattr(ticks, "publisher", lambda *_: topic)
        monkeypatch.setattr(node, "Tuning", lambda p: SimpleNamespace(params=p))
        monkeypatch.setattr(node.actionlib, "SimpleActionServer", lambda *_, **__: self)
        monkeypatch.setattr(node.GotoNode, "answer_idle_ticks", lambda self: None)
        monkeypatch.setattr(node.GotoNode, "is_in_lockstep", lambda self: False)
        self.start = self.is_active = self.is_new_goal_available = lambda: False
        self.publish_feedback = self.feedback.append
        self.set_succeeded, self.set_preempted, self.set_aborted = map(
            self.ends_as, ("succeeded", "preempted", "aborted")
        )
        self.node = node.GotoNode(GotoParams())

    def subscribe(self, topic, kind, callback, **_):
        self.callbacks[topic] = callback
        return SimpleNamespace(get_num_connections=lambda: 1)

    def publish(self, message):
        self.speeds += [message.linear.x] if hasattr(message, "linear") else []

    def ends_as(self, state):
        return lambda result, text: self.ended.append((state, result.success, result.message))

    def register_preempt_callback(self, callback):
        self.on_preempt = callback

    def is_preempt_requested(self):
        requested = self.is_cancelled
        if self.node.ticks.answered == self.node.ticks.newest():  # no control period is due
            self.waits.set()
        return requested

    def reach(self, seconds, x=0.0):
        """The clock, odometry and a free scan of this time."""
        self.now = rospy.Time.from_sec(seconds)
        odom = Odometry()
        odom.header.frame_id = "odom"
        odom.pose.pose.position.x, odom.pose.pose.orientation.w = x, 1.0
        self.callbacks["odom"](odom)
        self.callbacks["scan"](LaserScan(angle_increment=0.1, range_max=5.0, ranges=[4.0]))
        self.callbacks["/clock"](Clock(self.now))

    def execute(self, interrupt=lambda: None, x=1.0):
        """Run a goal, interrupted when it waits for a tick; how it ended."""
        running = threading.Thread(target=self.node.execute, args=(GoToPositionGoal(Point(x, 0.0, 0.0)),), daemon=True)
        running.start()
        if interrupt is not None:
            assert self.waits.wait(DEADLINE)
            interrupt()
        running.join(DEADLINE)
        return self.ended

    def cancel(self):
        """As a client."""
        self.is_cancelled = True
        self.on_preempt()


@pytest.fixture
def system(monkeypatch):
    return System(monkeypatch)


def test_goal_at_the_robot_is_reached_in_the_first_control_period(system):
    system.reach(0.1, x=0.95)
    assert system.execute(None) == [
        ("succeeded", True, "REACHED: 0.050 m from the goal x 1.00 y 0.00 in odom after 0.0 s")
    ]
    assert [feedback.message for feedback in system.feedback] == ["reached"]


def test_goal_drives_the_robot_with_feedback_until_it_ends(system):
    system.reach(0.1)
    system.execute(system.cancel)
    assert system.speeds == [pytest.approx(GotoParams().linear_acceleration / GotoParams().control_rate), 0.0]
    assert [feedback.message for feedback in system.feedback] == ["driving, 1.00 m to go"]


@pytest.mark.parametrize("x", [math.nan, math.inf, -1e39])
def test_goal_that_is_no_position_is_aborted_at_once_and_the_robot_stays(system, x):
    ((state, success, text),) = system.execute(None, x=x)
    assert (state, success, text.split(" y ")[0]) == ("aborted", False, f"BAD_GOAL: position x {x}")
    assert system.speeds == [0.0]


def test_goal_that_got_stuck_names_the_other_nodes_that_command_the_robot(system, monkeypatch):
    commanding = {"/x": ["/teleop", rospy.get_name()], "/y": ["/other"]}
    monkeypatch.setattr(node.master, "publishers", lambda uri, topic: {topic: commanding[topic]})
    execution = node.GoalExecution(GoToPositionGoal(), system.node.inputs)
    system.node.set_terminal_state(execution, node.Ending(node.Outcome.STUCK, "no progress"))
    assert system.ended == [("aborted", False, "STUCK: no progress; /x is also published by /teleop")]


def test_cancel_ends_the_goal_while_the_clock_stands(system):
    text = "PREEMPTED: goal x 1.00 y 0.00 stopped after 0.0 s: it was cancelled"
    assert system.execute(system.cancel) == [("preempted", False, text)]
    assert system.speeds == [0.0]


def test_shutdown_ends_the_goal_while_the_clock_stands(system):
    text = "SHUTDOWN: goal x 1.00 y 0.00 stopped after 0.0 s: the server is shutting down"
    assert system.execute(system.node.shut_down) == [("aborted", False, text)]
    assert system.node.clock_error == ""


def test_clock_that_is_set_back_ends_the_goal_and_the_node(system):
    reason = "simulated time was set back from 5.0 to 0.3 s"
    system.now = rospy.Time(5)
    system.callbacks["/clock"](Clock(system.now))
    system.node.ticks.answered = 5 * 10**9  # the tick at which the server is idle
    ((_, _, text),) = system.execute(lambda: system.reach(0.3))
    assert text.endswith(f": {reason}") and system.node.clock_error == reason
