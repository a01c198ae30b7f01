"""Sends a goal from the command line and follows the goal to its end, with its progress on the screen."""

import argparse
import sys
import time
from typing import Optional

import actionlib
import rosgraph
import rospy
from geometry_msgs.msg import Point, PoseStamped
from nav_msgs.msg import Odometry

from aro_robocop_goto_as.msg import GoToPositionAction, GoToPositionFeedback, GoToPositionGoal

from ...errors import FrameError
from ...names import ACTION, absolute_if_named, position_text, prefixed
from ...process import signals
from .. import graph
from ..client import discovery
from ..client.goal_frame import GoalTransformer
from ..client.goal_states import STATES, ending
from ..waiting import wait_until
from .goto_arguments import DEFAULT_FRAME, NOT_REACHED, REACHED, SERVER_TIMEOUT, complain, tell

ROBOT_FRAMES = ("odom", "base_footprint", "base_link", "base_scan")  # each of several robots has its own
SILENCE = 5.0  # [s, wall] from sending a goal until it is said what a half-done server lacks
POLL = 0.1  # [s, wall]
MOVED = 0.001  # [m] or in the quaternion's z


class Follower:
    """One robot's action client and odometry, and what has been seen of its goal."""

    def __init__(self, robot: str) -> None:
        self.action = absolute_if_named(robot, ACTION)
        self.cmd_vel = absolute_if_named(robot, "cmd_vel")
        self.odom: Optional[Odometry] = None
        self.phase = ""  # of the newest feedback, "" before the first
        rospy.Subscriber(absolute_if_named(robot, "odom"), Odometry, self._store, queue_size=1)
        self.client = actionlib.SimpleActionClient(self.action, GoToPositionAction)

    def _store(self, message: Odometry) -> None:
        self.odom = message

    def wait_for_server(self) -> bool:
        """Whether the server is up within SERVER_TIMEOUT; says what it waits for, and what may be wrong."""
        if not discovery.is_up(self.client):
            tell(f"waiting for {self.action}")
            wait_until(lambda: discovery.is_up(self.client), SERVER_TIMEOUT)
        signals.reraise_if_interrupted()  # rospy may have swallowed it
        if discovery.is_up(self.client):
            return True
        hint = discovery.hint(self.action, " --robot NAME chooses it") or f"; {discovery.advice()}"
        complain(f"no answer from {self.action} for {SERVER_TIMEOUT:g} s{hint}")
        return False

    def show(self, feedback: GoToPositionFeedback) -> None:
        """Print feedback: on a terminal in one line that is overwritten, elsewhere once for each phase."""
        errors = f"distance {feedback.position_error:6.2f} m   angle {feedback.angle_error:+6.2f} rad"
        phase = feedback.message.split(",")[0] or "feedback"
        if sys.stdout.isatty():
            print(f"\r\033[K{errors}   {feedback.message}", end="", flush=True)
        elif phase != self.phase:
            tell(f"{errors}   {feedback.message}")
        self.phase = phase

    def missing(self, start: Optional[Odometry]) -> str:
        """What a server at work would have done since the odometry `start`, in words; empty if it did all of it."""
        try:
            published = any(topic.name == rospy.resolve_name(self.cmd_vel) for topic in graph.published_topics())
        except (OSError, rosgraph.MasterException):
            return "the ROS master does not answer"
        lacks = {
            "no feedback": not self.phase,
            f"nobody publishes {self.cmd_vel}": not published,
            "the robot has not moved": not _moved(start, self.odom),
        }
        return "; ".join(text for text, is_so in lacks.items() if is_so)

    def follow(self, position: Point) -> int:
        """Send a position in odom, show feedback, cancel on Ctrl-C; returns the exit status."""
        start, due = self.odom, time.monotonic() + SILENCE
        with signals.Deferred():  # a goal that was sent must be known, or it can't be cancelled
            self.client.send_goal(GoToPositionGoal(position), feedback_cb=self.show)
        try:
            while not self._has_ended():
                signals.reraise_if_interrupted()
                if not discovery.is_up(self.client):
                    complain("the server is gone")
                    return NOT_REACHED
                if time.monotonic() > due:
                    due = float("inf")
                    lacks = self.missing(start)
                    if lacks:
                        complain(f"after {SILENCE:g} s: {lacks}")
                time.sleep(POLL)
        except KeyboardInterrupt:
            self.client.cancel_goal()
            wait_until(self._has_ended, SERVER_TIMEOUT)
        return self._report()

    def _has_ended(self) -> bool:
        """Not by SimpleActionClient's own state, which misses an end that comes before send_goal() has returned."""
        return bool(self.client.gh.get_comm_state() == actionlib.CommState.DONE)

    def _report(self) -> int:
        """Print how the goal ended, with actionlib's own text where the result has none; returns the exit status."""
        if not self._has_ended():
            tell("no answer from the server")
            return NOT_REACHED
        state, result = self.client.gh.get_goal_status(), self.client.get_result()
        line, text = ending(state, result), self.client.get_goal_status_text()
        if sys.stdout.isatty():
            print("\r\033[K", end="")
        tell(f"{line}: {text}" if text and line == STATES[state] else line)
        return REACHED if result is not None and result.success else NOT_REACHED


def _moved(start: Optional[Odometry], now: Optional[Odometry]) -> bool:
    if start is None or now is None:
        return now is not None
    before, after = start.pose.pose, now.pose.pose
    changes = (
        after.position.x - before.position.x,
        after.position.y - before.position.y,
        after.orientation.z - before.orientation.z,
    )
    return any(abs(change) > MOVED for change in changes)


def go_to(args: argparse.Namespace) -> int:
    """Transform the goal, send it to the server and wait for its end; returns the exit status."""
    try:
        rospy.init_node("robocop_goto", anonymous=True, disable_signals=True)
        return _go_to(args)
    finally:
        rospy.signal_shutdown("done")


def _go_to(args: argparse.Namespace) -> int:
    odom, follower = prefixed(args.robot, "odom"), Follower(args.robot)
    transformer = GoalTransformer(odom, odom, SERVER_TIMEOUT, lambda: follower.odom)
    if not follower.wait_for_server():
        return NOT_REACHED
    pose = PoseStamped()
    pose.header.frame_id = prefixed(args.robot, args.frame) if args.frame in ROBOT_FRAMES else args.frame
    pose.pose.position = Point(args.x, args.y, 0.0)
    try:
        position = transformer.resolve(pose)
    except FrameError as error:
        signals.reraise_if_interrupted()
        complain(str(error))
        if args.frame == DEFAULT_FRAME:
            complain("--frame odom gives X and Y relative to where the robot's odometry started")
        return NOT_REACHED
    in_odom = f", {position_text(position.x, position.y, odom)}" if pose.header.frame_id != odom else ""
    tell(f"goal x {args.x:g} y {args.y:g} in {pose.header.frame_id}{in_odom}")
    return follower.follow(position)
