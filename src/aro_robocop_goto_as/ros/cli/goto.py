"""robocop goto: send one goal from the command line, show its progress, report the result as exit status."""

import argparse
import math
import os
import re
import sys
import time
from pathlib import Path
from typing import List, Optional

import actionlib
import rospkg
import rospy
from geometry_msgs.msg import Point, PoseStamped
from nav_msgs.msg import Odometry

from aro_robocop_goto_as.msg import GoToPositionAction, GoToPositionFeedback

from ...bootstrap import master
from ...errors import FrameError, MasterError
from ...process import signals
from .. import private_api
from ..action import ACTION
from ..client import discovery
from ..client.goal_frame import GoalTransformer
from ..client.goal_handle import SentGoal
from ..ticker import wait_until
from .own_system import own_system

SERVER_PATIENCE = 5.0  # [s, wall] for the server of a running system
START_PATIENCE = 60.0  # [s, wall] for the server of a system started for this goal, also on a slow machine
REACHED, NOT_REACHED = 0, 1
DEFAULT_FRAME = "map"  # in which RViz gives its 2D Nav Goals
ROBOT_FRAMES = ("odom", "base_footprint", "base_link", "base_scan")  # each of several robots has its own
PAUSE_PATIENCE = 1.0  # [s, wall] without a change of simulated time
PAUSED = "simulated time does not advance; is the simulator paused? (rosservice call /robocop_sim/unpause)"


def _parse(argv: List[str]) -> argparse.Namespace:
    parser = argparse.ArgumentParser(
        prog="robocop goto",
        description="Send one goal and follow it; exit status 0 when it is reached, 1 when not.",
        epilog="Uses the running ROS system; without one it starts a headless simulator for this goal.",
    )
    private_api.accept_scientific_notation(parser)
    parser.add_argument("x", type=_finite, help="[m]")
    parser.add_argument("y", type=_finite, help="[m]")
    parser.add_argument(
        "--frame",
        default=DEFAULT_FRAME,
        help="of X and Y: map (default; as a click in RViz), odom, base_footprint (relative to the robot), ...",
    )
    parser.add_argument("--robot", default="", help="name of one of several robots; frames are given without it")
    parser.add_argument("--world", help="world of the simulator, if one has to be started")
    return parser.parse_args(argv)


def _finite(text: str) -> float:
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if not math.isfinite(value):
        raise argparse.ArgumentTypeError(f"expected a finite number of metres, got {text!r}")
    return value


def _complain(text: str) -> None:
    print(f"robocop goto: {text}", file=sys.stderr, flush=True)


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
            print(line, flush=True)
        self.phase = phase

    def close(self) -> None:
        if self.on_terminal:
            print("\r\033[K", end="")


class _PauseNotice:
    """Prints a notice once when simulated time stops advancing."""

    def __init__(self) -> None:
        self.time = rospy.get_rostime()
        self.since = time.monotonic()
        self.printed = False

    def poll(self) -> None:
        now = rospy.get_rostime()
        if now != self.time:
            self.time, self.since, self.printed = now, time.monotonic(), False
        elif time.monotonic() - self.since > PAUSE_PATIENCE and not self.printed:
            self.printed = True
            _complain(PAUSED)


def _topic(robot: str, name: str) -> str:
    return f"/{robot}/{name}" if robot else name


def _frame(robot: str, frame: str) -> str:
    """The robot's own frame of that name; shared frames such as map are unchanged."""
    return f"{robot}/{frame}" if robot and frame in ROBOT_FRAMES else frame


def _go_to(args: argparse.Namespace, patience: float) -> int:
    """Transform the goal, send it to the server and wait for its end; returns the exit status."""
    rospy.init_node("robocop_goto", anonymous=True, disable_signals=True)
    started = rospy.get_rostime()
    latest: List[Optional[Odometry]] = [None]
    rospy.Subscriber(_topic(args.robot, "odom"), Odometry, lambda message: latest.__setitem__(0, message), queue_size=1)
    odom = _frame(args.robot, "odom")
    transformer = GoalTransformer(odom, odom, SERVER_PATIENCE, lambda: latest[0])
    action = _topic(args.robot, ACTION)
    client = actionlib.ActionClient(action, GoToPositionAction)
    missing = discovery.wait_or_explain(client, action, patience)
    signals.reraise_if_interrupted()  # rospy may have swallowed it
    if missing:
        _complain(missing)
        return NOT_REACHED
    pose = PoseStamped()
    pose.header.frame_id = _frame(args.robot, args.frame)
    pose.pose.position = Point(args.x, args.y, 0.0)
    try:
        position = transformer.resolve(pose)
    except FrameError as error:
        signals.reraise_if_interrupted()
        _complain(str(error))
        if args.frame == DEFAULT_FRAME:
            _complain("--frame odom gives X and Y relative to where the robot's odometry started")
        if rospy.get_rostime() == started:
            _complain(PAUSED)
        return NOT_REACHED
    return _follow(client, position)


def _follow(client: actionlib.ActionClient, position: Point) -> int:
    """Send a position in odom, show feedback, cancel on Ctrl-C."""
    progress, pause = _ProgressLine(), _PauseNotice()
    ending: List[str] = []
    goal: Optional[SentGoal] = None
    try:
        with signals.Deferred():  # a goal that was sent must be known, or it can't be cancelled
            goal = SentGoal(client, position, ending.append, progress.show)
        while not goal.done.wait(0.1):
            signals.reraise_if_interrupted()
            pause.poll()
            if not discovery.is_up(client):
                progress.close()
                _complain("the server is gone")
                return NOT_REACHED
    except KeyboardInterrupt:
        if goal is None:
            raise
        goal.cancel()
        wait_until(goal.done.is_set, SERVER_PATIENCE)
    progress.close()
    print(ending[0] if ending else "no answer from the server")
    return REACHED if goal.result is not None and goal.result.success else NOT_REACHED


def main() -> None:
    """Entry point; exit status 0 when the goal is reached, 1 when not, 2 for invalid arguments."""
    args = _parse(rospy.myargv()[1:])
    signals.interrupt_on_signal()
    try:
        sys.exit(_run(args))
    except KeyboardInterrupt:
        rospy.signal_shutdown("interrupted")
        _complain("interrupted")
        os._exit(NOT_REACHED)  # a half-constructed object, such as a tf2 listener, can't be destroyed properly


def _run(args: argparse.Namespace) -> int:
    try:
        system_runs = master.master_answers(master.master_uri())
    except MasterError as error:
        _complain(str(error))
        return NOT_REACHED
    if system_runs:
        if args.world:
            _complain("--world is ignored: a ROS system is already running")
        return _go_to(args, SERVER_PATIENCE)
    if args.robot:
        _complain(
            f"--robot {args.robot}: no ROS master answers, and a simulator started for one goal has one robot only"
        )
        return NOT_REACHED
    print("robocop goto: no ROS master answers; starting a headless simulator for this goal", flush=True)
    arguments = ["rviz:=false"]
    if args.world:
        world = os.path.abspath(args.world) if os.path.isfile(args.world) else args.world
        arguments.append(f"world:={world}")
    log = Path(rospkg.get_ros_home(), "robocop_goto.log")
    status = NOT_REACHED
    with own_system("robocop_goto_as.launch", arguments, log) as started:
        if started:
            status = _go_to(args, START_PATIENCE)
    errors = [line for line in _lines(log) if "[FATAL]" in line]
    if errors or not started:
        lines = ["the system started for this goal failed:", *errors, f"its complete output is in {log}"]
        _complain("\n".join(lines))
    return status


def _lines(log: Path) -> List[str]:
    """The log's lines without terminal colours."""
    return [re.sub(r"\x1b\[[0-9;]*m", "", line).rstrip() for line in log.read_text(errors="replace").splitlines()]
