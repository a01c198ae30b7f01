"""robocop goto: send one goal from the command line, show its progress, report the result as exit status."""

import argparse
import math
import os
import re
import sys
import time
from typing import List, Optional

import rosgraph
import rospy
from geometry_msgs.msg import Point, Pose, PoseStamped
from nav_msgs.msg import Odometry

from aro_robocop_goto_as.msg import GoToPositionFeedback

from ...errors import FrameError, MasterError
from ...names import ACTION, absolute_if_named, position_text, prefixed, robocop
from ...param_loading import MAX_COORDINATE
from ...process import signals
from ...process.start import typed
from .. import graph, settings
from ..client.goal_follower import GoalFollower
from ..client.goal_frame import GoalTransformer
from ..waiting import wait_until

REACHED, NOT_REACHED = 0, 1  # exit statuses; 2 for wrong arguments is argparse's own
NEGATIVE = re.compile(r"-[\d.]+([eE][-+]?\d+)?")
DEFAULT_FRAME = "map"  # in which RViz gives its 2D Nav Goals
ROBOT_FRAMES = ("odom", "base_footprint", "base_link", "base_scan")  # each of several robots has its own
SERVER_TIMEOUT = 5.0  # [s, wall] for the server, and for the transform of the goal
SILENCE = 5.0  # [s, wall] from sending a goal until it is said what a half-done server lacks
POLL = 0.1  # [s, wall]


def parse(argv: List[str]) -> argparse.Namespace:
    """The arguments; ends the program with exit status 2 if they are wrong."""
    parser = argparse.ArgumentParser(
        prog=typed("goto"),
        description="Send one goal and follow it to its end.",
        epilog="Needs a running system, such as that of `robocop run`. Exit status 0 if the goal is reached, 1 if not, "
        "2 for wrong arguments.",
    )
    parser.add_argument("x", metavar="X", type=_metres, help="[m]")
    parser.add_argument("y", metavar="Y", type=_metres, help="[m]")
    parser.add_argument(
        "--frame",
        default=DEFAULT_FRAME,
        help="of X and Y: map (default; as a click in RViz), odom, base_footprint (relative to the robot), ...",
    )
    parser.add_argument(
        "--robot", metavar="NAME", default="", help="one of several robots; frames are given without its name"
    )
    # argparse takes -5e-1 for an option, but not with a space before it.
    args = parser.parse_args([f" {word}" if NEGATIVE.fullmatch(word) else word for word in argv])
    if not args.frame:
        parser.error("--frame: expected the name of a frame, got nothing")
    return args


def _metres(text: str) -> float:
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if not abs(value) <= MAX_COORDINATE:  # true for NaN
        raise argparse.ArgumentTypeError(
            f"expected a number of metres within +-{MAX_COORDINATE:g}, got {text.strip()!r}"
        )
    return value


class Goto:
    """The goal of a command line, the odometry of its robot, and what has been seen of the goal."""

    def __init__(self, args: argparse.Namespace) -> None:
        self.args = args
        self.action = absolute_if_named(args.robot, ACTION)
        self.cmd_vel = absolute_if_named(args.robot, "cmd_vel")
        self.goal_frame = prefixed(args.robot, "odom")
        self.odom: Optional[Odometry] = None
        self.phase = ""  # of the newest feedback, "" before the first
        rospy.Subscriber(absolute_if_named(args.robot, "odom"), Odometry, self._store, queue_size=1)
        self.goal = GoalFollower(self.action, self.show)
        self.transformer = GoalTransformer(self.goal_frame, self.goal_frame, SERVER_TIMEOUT)

    def _store(self, message: Odometry) -> None:
        self.odom = message

    def run(self) -> int:
        """Wait for the server, transform the goal, follow it; returns the exit status."""
        if not self.goal.is_up():
            tell(f"waiting for {self.action}")
            wait_until(self.goal.is_up, SERVER_TIMEOUT)
        signals.reraise_if_interrupted()  # rospy may have swallowed it
        if not self.goal.is_up():
            why = graph.no_simulator() or (
                "if it has ended, the terminal of its system says why; --robot NAME chooses one of several robots"
            )
            complain(f"no answer from {self.action} for {SERVER_TIMEOUT:g} s: {why}")
            return NOT_REACHED
        try:
            position = self.position()
        except FrameError as error:
            signals.reraise_if_interrupted()
            complain(str(error))
            if self.args.frame == DEFAULT_FRAME:
                complain("--frame odom gives X and Y relative to where the robot's odometry started")
            return NOT_REACHED
        return self.follow(position)

    def position(self) -> Point:
        """The goal in odom, once it is told."""
        args, pose = self.args, PoseStamped()
        pose.header.frame_id = prefixed(args.robot, args.frame) if args.frame in ROBOT_FRAMES else args.frame
        pose.pose.position = Point(args.x, args.y, 0.0)
        position = self.transformer.resolve(pose)
        text = f"goal x {args.x:g} y {args.y:g} in {pose.header.frame_id}"
        if pose.header.frame_id != self.goal_frame:
            text += f", {position_text(position.x, position.y, self.goal_frame)}"
        tell(text)
        return position

    def follow(self, position: Point) -> int:
        """Send a position in odom, show feedback, cancel on Ctrl-C; returns the exit status."""
        start, due = self.odom, time.monotonic() + SILENCE
        try:
            with signals.Deferred():  # a goal that was sent must be known, or it can't be cancelled
                self.goal.send(position)
            while not self.goal.has_ended():
                signals.reraise_if_interrupted()
                if not self.goal.is_up():
                    complain("the server is gone")
                    return NOT_REACHED
                if time.monotonic() > due:
                    due = math.inf
                    lacks = self.missing(start)
                    if lacks:
                        complain(f"after {SILENCE:g} s: {lacks}")
                time.sleep(POLL)
        except KeyboardInterrupt:
            self.goal.cancel(SERVER_TIMEOUT)
        if sys.stdout.isatty():
            print("\r\033[K", end="")
        tell(self.goal.state() if self.goal.has_ended() else "no answer from the server")
        return REACHED if self.goal.is_reached() else NOT_REACHED

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
            "the robot has not moved": _pose(start) == _pose(self.odom),
        }
        return "; ".join(text for text, is_so in lacks.items() if is_so)


def _pose(odometry: Optional[Odometry]) -> Optional[Pose]:
    return None if odometry is None else odometry.pose.pose


def tell(text: str) -> None:
    """Print a line to standard output."""
    print(text, flush=True)


def complain(text: str) -> None:
    """Print a message to standard error."""
    print(f"robocop goto: {text}", file=sys.stderr, flush=True)


def main() -> None:
    """Entry point; exit status 0 when the goal is reached, 1 when not, 2 for invalid arguments."""
    args = parse(sys.argv[1:])
    signals.interrupt_on_signal()
    try:
        sys.exit(_run(args))
    except KeyboardInterrupt:
        complain("interrupted")
        os._exit(NOT_REACHED)  # a half-constructed object, such as a tf2 listener, can't be destroyed properly


def _run(args: argparse.Namespace) -> int:
    uri = rosgraph.get_master_uri()
    try:
        problem = settings.problem()
        if not problem and not graph.master_answers():
            problem = f"no ROS master answers at {uri}: start a system with {robocop()} run in another terminal"
    except MasterError as error:
        problem = str(error)
    if problem:
        complain(problem)
        return NOT_REACHED
    try:
        rospy.init_node("robocop_goto", anonymous=True, disable_signals=True)
        return Goto(args).run()
    finally:
        rospy.signal_shutdown("done")
