"""What the rostests share: waiting with a deadline, recorded topics, goals, the robot as it really is, processes.

Every wait is for a condition and has a deadline on the wall clock, long enough for a machine that is busy with other
work: reaching it always means a failure.
"""

import itertools
import math
import os
import signal
import subprocess
import sys
import threading
import time
import unittest
import xmlrpc.client

import rosgraph
import roslib.packages
import rospy
import rostest
from actionlib_msgs.msg import GoalID, GoalStatus, GoalStatusArray
from aro_robocop_goto_as.msg import GoToPositionActionFeedback, GoToPositionActionGoal, GoToPositionActionResult
from aro_robocop_goto_as.srv import Reset
from geometry_msgs.msg import Twist
from nav_msgs.msg import Odometry
from rosgraph.names import ns_join
from rosgraph_msgs.msg import Log
from std_srvs.srv import Trigger

from aro_robocop_goto_as.geometry import Pose2D
from aro_robocop_goto_as.nodes.convert import from_pose_msg

PACKAGE = "aro_robocop_goto_as"
ACTION = "robocop_goto_as"
SERVER = "/aro_robocop_goto_as_node"
BRIDGE = "/robocop_rviz_goto_ac_node"
SIMULATOR = "/robocop_sim"
DEADLINE = 60.0  # [s, wall]
POLL = 0.005  # [s, wall]
TERMINAL = (GoalStatus.PREEMPTED, GoalStatus.SUCCEEDED, GoalStatus.ABORTED, GoalStatus.REJECTED, GoalStatus.RECALLED)
STATES_OF = {"REACHED": (GoalStatus.SUCCEEDED,), "PREEMPTED": (GoalStatus.PREEMPTED, GoalStatus.RECALLED)}


def wait_for(condition, what, deadline=DEADLINE):
    """The first true value of `condition`; AssertionError with `what` (or what it returns) after the deadline."""
    end = time.monotonic() + deadline
    while True:
        value = condition()
        if value:
            return value
        if time.monotonic() > end or rospy.is_shutdown():
            raise AssertionError(f"not within {deadline:g} s: {what() if callable(what) else what}")
        time.sleep(POLL)


def run(test_case):
    """Run a TestCase as the test node that rostest started."""
    name = os.path.splitext(os.path.basename(sys.argv[0]))[0]
    rospy.init_node(name)
    rostest.rosrun(PACKAGE, name, test_case)


class Recorder:
    """Every message of a topic, in order of arrival, each with the ROS time [s] at which it came."""

    def __init__(self, topic, kind, wait=True):
        self.topic = topic
        self.messages = []
        self.times = []
        self._subscriber = rospy.Subscriber(topic, kind, self._on_message)
        if wait:
            wait_for(self._subscriber.get_num_connections, f"somebody publishes {topic}")

    def __len__(self):
        return len(self.messages)

    def _on_message(self, message):
        self.times.append(rospy.get_time())
        self.messages.append(message)

    def forget(self):
        """Drop what has come so far."""
        self.messages, self.times = [], []

    def wait_for(self, wanted, what, start=0):
        """The first message from number `start` on of which `wanted` is true."""
        return wait_for(lambda: next((m for m in self.messages[start:] if wanted(m)), None),
                        lambda: f"{what} on {self.topic}; the last one: {self.messages[-1:]}")

    def take(self, count=1):
        """The next `count` messages from now on."""
        start = len(self)
        wait_for(lambda: len(self) >= start + count, f"{count} more messages on {self.topic}")
        return self.messages[start:start + count]

    def newest(self):
        """The message that came last; waits for the first one."""
        return self.messages[-1] if self.messages else self.take()[0]


def wait_for_subscriber(publisher, node):
    """Wait until a node listens to what this node publishes."""
    wait_for(lambda: publisher.impl.has_connection(node), f"{node} listens to {publisher.name}")


def call_simulator(service):
    """Have the simulator pause, unpause or reset; what it answers."""
    name = f"{SIMULATOR}/{service}"
    rospy.wait_for_service(name, DEADLINE)
    answer = rospy.ServiceProxy(name, {"reset": Reset}.get(service, Trigger))()
    assert answer.success, answer.message
    return answer.message


def distance(a, b):
    """Between two poses on the plane [m]."""
    return math.hypot(a.x - b.x, a.y - b.y)


class Goal:
    """One goal, told apart by its id, as its server's topics show it."""

    def __init__(self, goals, goal_id):
        self.goals = goals
        self.id = goal_id

    def results(self):
        """All of its results: there should be one."""
        return [m for m in self.goals.results.messages if m.status.goal_id.id == self.id]

    def result(self, word=None):
        """Its result once it has come; with `word`, that it starts with it."""
        found = wait_for(self.results, f"a result for goal {self.id}; states so far: {self.states()}")[0]
        if word is not None:
            assert found.result.message.startswith(word + ": "), f"expected {word}, got {found.result.message!r}"
        return found

    def feedback(self):
        """All of its feedback messages, headers and all."""
        return [m for m in self.goals.feedback.messages if m.status.goal_id.id == self.id]

    def wait_for_feedback(self, wanted, what):
        """The first feedback message of which `wanted` is true."""
        return wait_for(lambda: next((m for m in self.feedback() if wanted(m.feedback)), None),
                        lambda: f"{what}; feedback so far: {[m.feedback.message for m in self.feedback()]}")

    def wait_until_it_drives(self):
        """Until the robot has begun to drive towards it."""
        self.wait_for_feedback(lambda feedback: feedback.message.startswith("driving"), f"goal {self.id} drives")

    def states(self):
        """Its states in order, as the status topic told them, each run of equal ones once."""
        told = [s.status for m in self.goals.statuses.messages for s in m.status_list if s.goal_id.id == self.id]
        return [state for i, state in enumerate(told) if i == 0 or state != told[i - 1]]

    def cancel(self):
        """Ask for it to be cancelled."""
        self.goals.cancel_topic.publish(GoalID(rospy.Time(), self.id))

    def check_end(self):
        """It has exactly one result and one terminal state; both fit to the word that the message starts with."""
        result = self.result()
        wait_for(lambda: self.states() and self.states()[-1] in TERMINAL, f"goal {self.id} in a terminal state")
        assert len(self.results()) == 1, f"goal {self.id} has {len(self.results())} results"
        ended = [state for state in self.states() if state in TERMINAL]
        assert ended == [self.states()[-1]] == [result.status.status], f"goal {self.id} went through {self.states()}"
        word, _, text = result.result.message.partition(": ")
        assert text, f"no words in the result of goal {self.id}: {result.result.message!r}"
        expected = STATES_OF.get(word, (GoalStatus.ABORTED,))
        assert result.status.status in expected, f"{word} ended in state {result.status.status}"
        assert result.result.success == (word == "REACHED"), f"success is {result.result.success} of {word}"


class Goals:
    """Sends goals by the plain topics that every action client uses, and watches those of all clients."""

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
        """A new goal in odom [m], stamped with ROS time unless told otherwise."""
        message = GoToPositionActionGoal()
        message.goal_id = GoalID(rospy.Time.now() if stamp is None else stamp, f"test-{next(self.numbers)}")
        message.goal.position.x, message.goal.position.y, message.goal.position.z = x, y, z
        self.goal_topic.publish(message)
        return Goal(self, message.goal_id.id)

    def forget(self):
        """Drop what has come so far."""
        for recorder in (self.results, self.statuses, self.feedback, self.sent, self.log):
            recorder.forget()

    def of_others(self):
        """The goals that came from elsewhere, such as the bridge, in order."""
        return [Goal(self, m.goal_id.id) for m in self.sent.messages if not m.goal_id.id.startswith("test-")]

    def cancel_all(self):
        """The request without an id, which means every goal."""
        self.cancel_topic.publish(GoalID())

    def check_ends(self):
        """Every goal has exactly one result and one terminal state, cancelled if need be; the server logs no error."""
        ids = {m.status.goal_id.id for m in self.results.messages}
        for goal_id in {m.goal_id.id for m in self.sent.messages if m.goal_id.id} - ids:
            Goal(self, goal_id).cancel()
            ids.add(goal_id)
        for goal_id in sorted(ids):
            Goal(self, goal_id).check_end()
        errors = [m.msg for m in self.log.messages if m.name == self.server and m.level >= Log.ERROR]
        assert not errors, f"the server logged {errors}"


class Robot:
    """A simulated robot as it really is; of many, the one in a namespace."""

    def __init__(self, namespace=""):
        self.truth = Recorder(ns_join(namespace, "ground_truth_odom"), Odometry)
        self.odom = Recorder(ns_join(namespace, "odom"), Odometry)
        self.commands = Recorder(ns_join(namespace, "cmd_vel"), Twist, wait=False)
        self.truth.newest()
        self.odom.newest()

    def reset(self):
        """Have the simulator put it back to its spawn; forget what came before."""
        call_simulator("reset")
        start = len(self.odom)
        self.odom.wait_for(lambda m: distance(from_pose_msg(m.pose.pose), Pose2D()) < 1e-4, "odometry at zero", start)
        self.odom.take(3)  # whoever else listens has heard of it as well
        self.forget()

    def forget(self):
        """Drop what has come so far."""
        for recorder in (self.truth, self.odom, self.commands):
            recorder.forget()

    def pose(self):
        """Where it really is now, in the world."""
        return self._pose_now(self.truth)

    def odom_pose(self):
        """Where odometry believes it is now."""
        return self._pose_now(self.odom)

    def _pose_now(self, recorder):
        """From the topic's first message that is no older than anything seen so far: topics don't arrive in step."""
        newest = max([rospy.Time.now()] + [r.newest().header.stamp for r in (self.truth, self.odom)])
        message = recorder.wait_for(lambda m: m.header.stamp >= newest, "a message of now")
        return from_pose_msg(message.pose.pose)

    def path(self):
        """Where it really was, from the test's beginning on."""
        return [from_pose_msg(m.pose.pose) for m in self.truth.messages]

    def wait_until_it_stands(self):
        """Until it was commanded to stand, and does; its pose then."""
        wait_for(lambda: self.commands.messages[-1:] == [Twist()], "the last command is to stand")
        return self.wait_for_standstill()

    def wait_for_standstill(self):
        """Until it stands, whatever made it; its pose then."""
        now = rospy.Time.now()
        standing = self.truth.wait_for(lambda m: m.header.stamp > now and not moves(m), "a robot that stands")
        return from_pose_msg(standing.pose.pose)

    def wait_until_it_drives(self, v=0.02):
        """Until it drives forward faster than `v` [m/s]."""
        start = len(self.truth)
        self.truth.wait_for(lambda m: m.twist.twist.linear.x > v, "a robot that drives", start)


class SystemTest(unittest.TestCase):
    """A test of the running system: each starts with the robot at its spawn, odometry at zero, and empty records."""

    @classmethod
    def setUpClass(cls):
        cls.goals = Goals()
        cls.robot = Robot()

    def setUp(self):
        self.robot.reset()
        self.goals.forget()

    def tearDown(self):
        self.goals.check_ends()


def moves(odometry):
    """Whether an odometry message tells of more than a crawl."""
    twist = odometry.twist.twist
    return abs(twist.linear.x) > 0.003 or abs(twist.angular.z) > 0.02


def in_world(spawn, point):
    """A point of odom in the world, before odometry has drifted."""
    cos, sin = math.cos(spawn.yaw), math.sin(spawn.yaw)
    return Pose2D(spawn.x + cos * point.x - sin * point.y, spawn.y + sin * point.x + cos * point.y)


def pid_of(node):
    """Process id of a running node."""
    master = rosgraph.Master(rospy.get_name())
    return xmlrpc.client.ServerProxy(master.lookupNode(node)).getPid(rospy.get_name())[2]


def script(name):
    """The path of one of this package's programs."""
    return roslib.packages.find_node(PACKAGE, name)[0]


class Process:
    """A program beside the test, in a process group of its own; as a context manager it is ended with the test."""

    def __init__(self, *command, **environment):
        self.lines = []
        self.process = subprocess.Popen(
            [str(word) for word in command], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True,
            start_new_session=True, env={**os.environ, "PYTHONUNBUFFERED": "1", **environment})
        self.pid = self.process.pid
        self._reader = threading.Thread(target=self._read, daemon=True)
        self._reader.start()

    def __enter__(self):
        return self

    def __exit__(self, *_):
        if self.process.poll() is None:
            self.process.send_signal(signal.SIGINT)
            try:
                self.process.wait(10.0)
            except subprocess.TimeoutExpired:
                os.killpg(self.pid, signal.SIGKILL)
        self.process.wait()
        self._reader.join()

    def _read(self):
        for line in self.process.stdout:
            self.lines.append(line)

    @property
    def output(self):
        """All that it has printed so far."""
        return "".join(self.lines)

    def wait_for_exit(self, deadline=DEADLINE):
        """Its exit status once it has ended by itself."""
        try:
            status = self.process.wait(deadline)
        except subprocess.TimeoutExpired:
            raise AssertionError(f"{self.process.args} still runs after {deadline:g} s:\n{self.output}") from None
        self._reader.join()
        return status
