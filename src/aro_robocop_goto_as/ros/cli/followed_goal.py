"""Sends a goal from the command line and follows the goal to its end, with its progress on the screen."""

import argparse
import math
import sys
import threading
import time
from typing import Any, Callable

import actionlib
import rospy
from geometry_msgs.msg import Point, PoseStamped
from nav_msgs.msg import Odometry

from aro_robocop_goto_as.msg import GoToPositionAction, GoToPositionFeedback, GoToPositionGoal, SimStatus

from ...errors import FrameError
from ...names import ACTION, SIMULATOR, absolute, absolute_if_named, position_text, prefixed, robocop
from ...probes import master
from ...process import signals
from ..client import discovery
from ..client.goal_frame import GoalTransformer
from ..client.goal_states import ending
from ..waiting import wait_until
from .goto_arguments import DEFAULT_FRAME, NOT_REACHED, REACHED, SERVER_TIMEOUT, complain, tell

ROBOT_FRAMES = ("odom", "base_footprint", "base_link", "base_scan")  # each of several robots has its own
PAUSE_TIMEOUT = 1.0  # [s, wall] without a change of simulated time
STATUS = absolute(SIMULATOR, "status")
SLIPPED = (
    "the wheels slipped at an obstacle, so odometry is wrong and the robot is not where it says; this puts robots and "
    f"odometry back: {robocop()} shell rosservice call {absolute(SIMULATOR, 'reset')} 0"
)
PAUSED = (
    "simulated time does not advance; is the simulator paused? "
    f"({robocop()} shell rosservice call {absolute(SIMULATOR, 'unpause')})"
)


def standstill() -> str:
    """Why simulated time may not advance, and what to do."""
    return master.no_simulator(master.master_uri()) or PAUSED


class _Newest:
    """The newest message of a topic; None before the first one."""

    def __init__(self, topic: str, kind: Any) -> None:
        self.message: Any = None
        rospy.Subscriber(topic, kind, self._store, queue_size=1)

    def _store(self, message: Any) -> None:
        self.message = message


class _ProgressLine:
    """On a terminal, one line that is overwritten; elsewhere, one line for each new phase."""

    def __init__(self) -> None:
        self.on_terminal = sys.stdout.isatty()
        self.phase = ""

    def show(self, feedback: GoToPositionFeedback) -> None:
        errors = f"distance {feedback.position_error:6.2f} m   angle {feedback.angle_error:+6.2f} rad"
        line = f"{errors}   {feedback.message}"
        if self.on_terminal:
            print("\r\033[K" + line, end="", flush=True)
            return
        phase = feedback.message.split(",")[0]
        if phase != self.phase:
            tell(line)
        self.phase = phase

    def close(self) -> None:
        if self.on_terminal:
            print("\r\033[K", end="")


class _PauseNotice:
    """Prints a notice once when simulated time stops advancing."""

    def __init__(self) -> None:
        self.time = rospy.get_rostime()
        self.since = time.monotonic()  # [s, wall]; infinite once the notice is printed

    def poll(self) -> None:
        now = rospy.get_rostime()
        if now != self.time:
            self.time, self.since = now, time.monotonic()
        elif time.monotonic() - self.since > PAUSE_TIMEOUT:
            self.since = math.inf
            complain(standstill())


def _frame(robot: str, frame: str) -> str:
    """The robot's own frame of that name; shared frames such as map are unchanged."""
    return prefixed(robot, frame) if frame in ROBOT_FRAMES else frame


def go_to(args: argparse.Namespace, timeout: float, ended: Callable[[], bool] = lambda: False) -> int:
    """Transform the goal, send it to the server and wait for its end; returns the exit status.

    `ended`: whether the system has ended, so that its server will not come.
    """
    try:
        return _go_to(args, timeout, ended)
    finally:
        rospy.signal_shutdown("done")


def _go_to(args: argparse.Namespace, timeout: float, ended: Callable[[], bool]) -> int:
    rospy.init_node("robocop_goto", anonymous=True, disable_signals=True)
    started = rospy.get_rostime()
    odometry, simulator = _Newest(absolute_if_named(args.robot, "odom"), Odometry), _Newest(STATUS, SimStatus)
    odom = _frame(args.robot, "odom")
    transformer = GoalTransformer(odom, odom, SERVER_TIMEOUT, lambda: odometry.message)
    action = absolute_if_named(args.robot, ACTION)
    client = actionlib.ActionClient(action, GoToPositionAction)
    missing = _wait_or_explain(client, action, timeout, ended)
    signals.reraise_if_interrupted()  # rospy may have swallowed it
    if missing:
        complain(missing)
        return NOT_REACHED
    pose = PoseStamped()
    pose.header.frame_id = _frame(args.robot, args.frame)
    pose.pose.position = Point(args.x, args.y, 0.0)
    try:
        position = transformer.resolve(pose)
    except FrameError as error:
        signals.reraise_if_interrupted()
        complain(str(error))
        if args.frame == DEFAULT_FRAME:
            complain("--frame odom gives X and Y relative to where the robot's odometry started")
        if rospy.get_rostime() == started:
            complain(standstill())
        return NOT_REACHED
    given = f"x {args.x:g} y {args.y:g} in {pose.header.frame_id}"
    in_odom = f", {position_text(position.x, position.y, odom)}" if pose.header.frame_id != odom else ""
    tell(f"goal {given}{in_odom}")
    status = follow(client, position)
    if simulator.message is not None and args.robot.strip("/") in simulator.message.slipped:
        complain(SLIPPED)
    return status


def _wait_or_explain(client: actionlib.ActionClient, action: str, timeout: float, ended: Callable[[], bool]) -> str:
    """Wait up to `timeout` [s, wall] for the server, or until its system has ended.

    An empty string, or why it may be missing and what to do.
    """
    started = time.monotonic()
    wait_until(lambda: discovery.is_up(client) or ended(), timeout)
    if discovery.is_up(client) and not ended():
        return ""
    if not rospy.get_rostime():
        return standstill()
    silence = f"no answer from {action} for {time.monotonic() - started:.0f} s"
    return f"{silence}{discovery.hint(action, ' --robot NAME chooses it') or '; ' + discovery.advice()}"


def follow(client: actionlib.ActionClient, position: Point) -> int:
    """Send a position in odom, show feedback, cancel on Ctrl-C; returns the exit status.

    SimpleActionClient knows its goal only once it has been sent: it logs an error about each change of state that comes
    before, and never tells of an end that does.
    """
    progress, pause, done = _ProgressLine(), _PauseNotice(), threading.Event()
    answer, is_reached, goal = "no answer from the server", False, None

    def on_transition(handle: actionlib.ClientGoalHandle) -> None:
        nonlocal answer, is_reached
        if handle.get_comm_state() == actionlib.CommState.DONE:
            result = handle.get_result()
            answer = ending(handle.get_goal_status(), result)
            is_reached = result is not None and result.success
            done.set()

    try:
        with signals.Deferred():  # a goal that was sent must be known, or it can't be cancelled
            goal = client.send_goal(GoToPositionGoal(position), on_transition, lambda _, newest: progress.show(newest))
        while not done.wait(0.1):
            signals.reraise_if_interrupted()
            pause.poll()
            if not discovery.is_up(client):
                progress.close()
                complain("the server is gone")
                return NOT_REACHED
    except KeyboardInterrupt:
        if goal is None:
            raise
        goal.cancel()
        done.wait(SERVER_TIMEOUT)
    progress.close()
    tell(answer)
    return REACHED if is_reached else NOT_REACHED
