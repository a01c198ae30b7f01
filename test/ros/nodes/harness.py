"""Shared by the rostests: waits with a deadline, recorded topics, goals, the robot's ground truth.

Every wait is for a condition and has a deadline on the wall clock, long enough for a busy machine: reaching it always
means a failure.
"""

import contextlib
import itertools
import math
import os
import sys
import unittest
import xmlrpc.client
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[2]))  # test/, as pytest has it

import rosgraph
import roslib.packages
import rospy
import rostest
import waiting
from actionlib_msgs.msg import GoalID, GoalStatus, GoalStatusArray
from aro_robocop_goto_as.msg import GoToPositionActionFeedback, GoToPositionActionGoal, GoToPositionActionResult
from aro_robocop_goto_as.srv import Reset
from geometry_msgs.msg import Twist
from nav_msgs.msg import Odometry
from rosgraph.names import ns_join
from rosgraph_msgs.msg import Log
from std_srvs.srv import Trigger

from aro_robocop_goto_as.geometry import Pose2D
from aro_robocop_goto_as.ros.convert import from_pose_msg

PACKAGE = "aro_robocop_goto_as"
ACTION = "robocop_goto_as"
SERVER = "/aro_robocop_goto_as_node"
BRIDGE = "/robocop_rviz_goto_ac_node"
SIMULATOR = "/robocop_sim"
DEADLINE = 60.0  # [s, wall]
POLL = 0.005  # [s, wall]
TERMINAL = (GoalStatus.PREEMPTED, GoalStatus.SUCCEEDED, GoalStatus.ABORTED, GoalStatus.REJECTED, GoalStatus.RECALLED)
CANCELLED_NOTHING = "Attempt to get a goal id on an uninitialized ServerGoalHandle"  # actionlib, of an unknown goal
STATES_OF = {"REACHED": (GoalStatus.SUCCEEDED,), "PREEMPTED": (GoalStatus.PREEMPTED,)}


def wait_for(condition, what, deadline=DEADLINE):
    """The first true value of `condition`; after the deadline AssertionError with `what`, which may be callable."""
    return waiting.wait_for(condition, what, deadline, POLL, given_up=rospy.is_shutdown)


def run(test_case):
    """Run a TestCase in this process as a test node of rostest."""
    name = os.path.splitext(os.path.basename(sys.argv[0]))[0]
    rospy.init_node(name)
    rostest.rosrun(PACKAGE, name, test_case)


class Recorder:
    """All messages of a topic in order of arrival."""

    def __init__(self, topic, kind, wait=True):
        self.topic = topic
        self.messages = []
        self._subscriber = rospy.Subscriber(topic, kind, self._on_message)
        if wait:
            wait_for(self._subscriber.get_num_connections, f"a publisher of {topic}")

    def __len__(self):
        return len(self.messages)

    def _on_message(self, message):
        self.messages.append(message)

    def close(self):
        """Unsubscribe."""
        self._subscriber.unregister()

    def clear(self):
        """Drop the messages received so far."""
        self.messages = []

    def wait_for(self, wanted, what, start=0):
        """The first message, counted from number `start`, for which `wanted` is true."""
        return wait_for(
            lambda: next((m for m in self.messages[start:] if wanted(m)), None),
            lambda: f"{what} on {self.topic}; the last message: {self.messages[-1:]}",
        )

    def next(self, count=1):
        """The next `count` messages from now on."""
        start = len(self)
        wait_for(lambda: len(self) >= start + count, f"{count} more messages on {self.topic}")
        return self.messages[start : start + count]

    def newest(self):
        """The last message received; waits for the first one."""
        return self.messages[-1] if self.messages else self.next()[0]


def wait_for_subscriber(publisher, node):
    """Wait until a node is connected to a publisher of this node."""
    wait_for(lambda: publisher.impl.has_connection(node), f"{node} subscribes to {publisher.name}")


def wait_for_connection(node, topic, received=False):
    """Wait until a Python node sends a topic to this node, or receives it: here a new connection may be seen later."""
    topic, name = rospy.resolve_name(topic), rospy.get_name()
    wanted = [rospy.get_node_uri(), "i"] if received else [name, "o"]

    def connected():
        with contextlib.suppress(OSError, rosgraph.MasterError):  # the node starts
            links = xmlrpc.client.ServerProxy(rosgraph.Master(name).lookupNode(node)).getBusInfo(name)[2]
            return any(link[1:3] == wanted and link[4] == topic for link in links)

    wait_for(connected, f"{node} {'receives' if received else 'sends'} {topic}")


def call_simulator(service):
    """Pause, unpause or reset the simulator; the message of its response."""
    name = f"{SIMULATOR}/{service}"
    rospy.wait_for_service(name, DEADLINE)
    answer = rospy.ServiceProxy(name, {"reset": Reset}.get(service, Trigger))()
    assert answer.success, answer.message
    return answer.message


def distance(a, b):
    """Distance of two poses or points on the plane [m]."""
    return math.hypot(a.x - b.x, a.y - b.y)


class Goal:
    """One goal, identified by its id, as seen on its server's topics."""

    def __init__(self, goals, goal_id):
        self.goals = goals
        self.id = goal_id

    def results(self):
        """All of its results; there should be one."""
        return [m for m in self.goals.results.messages if m.status.goal_id.id == self.id]

    def result(self, word=None):
        """Its result, once published; with `word`, asserts that the message starts with that outcome."""
        found = wait_for(self.results, f"a result for goal {self.id}; states so far: {self.states()}")[0]
        if word is not None:
            assert found.result.message.startswith(word + ": "), f"expected {word}, got {found.result.message!r}"
        return found

    def feedback(self):
        """All of its feedback messages, with headers."""
        return [m for m in self.goals.feedback.messages if m.status.goal_id.id == self.id]

    def states(self):
        """Its states in the order of the status topic, without repetitions."""
        states = [s.status for m in self.goals.statuses.messages for s in m.status_list if s.goal_id.id == self.id]
        return [state for i, state in enumerate(states) if i == 0 or state != states[i - 1]]

    def cancel(self):
        """Request that it be cancelled."""
        self.goals.cancel_topic.publish(GoalID(rospy.Time(), self.id))

    def assert_ended_once(self):
        """It has one result and one terminal state, and both match the outcome that the message starts with.

        One that was replaced before it began has actionlib's own result, which is empty.
        """
        result = self.result()
        wait_for(lambda: self.states() and self.states()[-1] in TERMINAL, f"goal {self.id} in a terminal state")
        assert len(self.results()) == 1, f"goal {self.id} has {len(self.results())} results"
        ended = [state for state in self.states() if state in TERMINAL]
        assert ended == [self.states()[-1]] == [result.status.status], f"goal {self.id} went through {self.states()}"
        if result.status.status == GoalStatus.RECALLED:
            return
        word, _, text = result.result.message.partition(": ")
        assert text, f"no text in the result of goal {self.id}: {result.result.message!r}"
        expected = STATES_OF.get(word, (GoalStatus.ABORTED,))
        assert result.status.status in expected, f"{word} ended in state {result.status.status}"
        assert result.result.success == (word == "REACHED"), f"success is {result.result.success} of {word}"


class Goals:
    """Sends goals on the topics that every action client uses, and records the goals of all clients."""

    def __init__(self, action=ACTION, server=SERVER):
        self.results = Recorder(f"{action}/result", GoToPositionActionResult)
        self.statuses = Recorder(f"{action}/status", GoalStatusArray)
        self.feedback = Recorder(f"{action}/feedback", GoToPositionActionFeedback)
        self.sent = Recorder(f"{action}/goal", GoToPositionActionGoal, wait=False)
        self.log = Recorder("/rosout", Log, wait=False)
        self.goal_topic = rospy.Publisher(f"{action}/goal", GoToPositionActionGoal, queue_size=100)
        self.cancel_topic = rospy.Publisher(f"{action}/cancel", GoalID, queue_size=100)
        self.server = server
        self.numbers = itertools.count(1)
        for publisher in (self.goal_topic, self.cancel_topic):
            wait_for_subscriber(publisher, server)

    def send(self, x, y, z=0.0, stamp=None):
        """Send a goal in odom [m], by default stamped with the ROS time of now."""
        message = GoToPositionActionGoal()
        message.goal_id = GoalID(rospy.Time.now() if stamp is None else stamp, f"test-{next(self.numbers)}")
        message.goal.position.x, message.goal.position.y, message.goal.position.z = x, y, z
        self.goal_topic.publish(message)
        return Goal(self, message.goal_id.id)

    def clear(self):
        """Drop the messages received so far."""
        for recorder in (self.results, self.statuses, self.feedback, self.sent, self.log):
            recorder.clear()

    def of_others(self):
        """The goals of other clients, such as the bridge, in order."""
        return [Goal(self, m.goal_id.id) for m in self.sent.messages if not m.goal_id.id.startswith("test-")]

    def assert_each_ended_once(self):
        """Cancel all active goals; then each has one result and one terminal state, and the server logged no error."""
        ids = {m.status.goal_id.id for m in self.results.messages}
        for goal_id in {m.goal_id.id for m in self.sent.messages if m.goal_id.id} - ids:
            Goal(self, goal_id).cancel()
            ids.add(goal_id)
        for goal_id in sorted(ids):
            Goal(self, goal_id).assert_ended_once()
        errors = {m.msg for m in self.log.messages if m.name == self.server and m.level >= Log.ERROR}
        assert errors <= {CANCELLED_NOTHING}, f"the server logged {errors}"


class Robot:
    """A simulated robot, by ground truth and odometry; with several robots, the one in a namespace."""

    def __init__(self, namespace=""):
        self.truth = Recorder(ns_join(namespace, "ground_truth_odom"), Odometry)
        self.odom = Recorder(ns_join(namespace, "odom"), Odometry)
        self.commands = Recorder(ns_join(namespace, "cmd_vel"), Twist, wait=False)
        self.truth.newest()
        self.odom.newest()

    def reset(self):
        """Reset the simulator: the robot is at its spawn, and what was recorded before is dropped."""
        call_simulator("reset")
        start = len(self.odom)
        self.odom.wait_for(lambda m: distance(from_pose_msg(m.pose.pose), Pose2D()) < 1e-4, "odometry at zero", start)
        self.odom.next(3)  # by then other subscribers have received it too
        self.clear()

    def clear(self):
        """Drop the messages received so far."""
        for recorder in (self.truth, self.odom, self.commands):
            recorder.clear()

    def pose(self):
        """Its true pose now, in world."""
        return self._pose_now(self.truth)

    def odom_pose(self):
        """Its pose now by odometry, in odom."""
        return self._pose_now(self.odom)

    def _pose_now(self, recorder):
        """From the first message no older than any received so far, as topics do not arrive in step."""
        newest = max([rospy.Time.now()] + [r.newest().header.stamp for r in (self.truth, self.odom)])
        message = recorder.wait_for(lambda m: m.header.stamp >= newest, "a current message")
        return from_pose_msg(message.pose.pose)

    def path(self):
        """Its true poses since the records were cleared."""
        return [from_pose_msg(m.pose.pose) for m in self.truth.messages]

    def wait_until_it_stands(self):
        """Wait until the last command is zero and the robot stands; its true pose."""
        wait_for(lambda: self.commands.messages[-1:] == [Twist()], "a last command of zero")
        return self.wait_for_standstill()

    def wait_for_standstill(self):
        """Wait until it stands, whatever the commands; its true pose."""
        now = rospy.Time.now()
        standing = self.truth.wait_for(lambda m: m.header.stamp > now and not moves(m), "a robot that stands")
        return from_pose_msg(standing.pose.pose)

    def wait_until_it_drives(self, v=0.02):
        """Wait until it drives forward faster than `v` [m/s]."""
        start = len(self.truth)
        self.truth.wait_for(lambda m: m.twist.twist.linear.x > v, "a robot that drives", start)


class SystemTest(unittest.TestCase):
    """Tests of a running system. Each starts with the robot at its spawn, odometry at zero, and empty records."""

    goals = robot = None  # those of all tests in this process

    @classmethod
    def setUpClass(cls):
        SystemTest.goals = SystemTest.goals or Goals()
        SystemTest.robot = SystemTest.robot or Robot()

    def setUp(self):
        self.robot.reset()
        self.goals.clear()

    def tearDown(self):
        self.goals.assert_each_ended_once()


def moves(odometry):
    """Whether the twist of an odometry message is more than a crawl."""
    twist = odometry.twist.twist
    return abs(twist.linear.x) > 0.003 or abs(twist.angular.z) > 0.02


def script(name):
    """The path of one of this package's scripts."""
    return roslib.packages.find_node(PACKAGE, name)[0]
