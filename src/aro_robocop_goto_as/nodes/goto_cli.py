"""robocop goto: one goal from the command line, a live progress line, the result as exit status."""

import argparse
import math
import os
import re
import sys
import time
from typing import List, Optional

import actionlib
import rospkg
import rospy
from geometry_msgs.msg import Point, PoseStamped
from nav_msgs.msg import Odometry

from aro_robocop_goto_as.msg import GoToPositionAction, GoToPositionFeedback

from ..errors import FrameError
from ..interruption import Deferred, as_ctrl_c, check
from . import action_servers
from .goal_frame import GoalTransformer
from .goto_as import ACTION
from .own_system import master_answers, own_system
from .sent_goal import SentGoal
from .ticker import wait_until

SERVER_PATIENCE = 5.0  # [s, wall] for the server of a system that is running
START_PATIENCE = 60.0  # [s, wall] for a system that is started for this goal, on a slow machine too
REACHED, NOT_REACHED = 0, 1
OWN_FRAMES = ("odom", "base_footprint", "base_link", "base_scan")  # of many robots each has its own
STANDSTILL_PATIENCE = 1.0  # [s, wall]
STANDING = "simulated time stands still; is the simulator paused? (rosservice call /robocop_sim/unpause)"


def _arguments(argv: List[str]) -> argparse.Namespace:
    parser = argparse.ArgumentParser(
        prog="robocop goto", description="Send one goal and follow it; exit status 0 when it is reached, 1 when not.",
        epilog="Uses the ROS system that runs; without one it starts a headless simulator for this goal.")
    parser._negative_number_matcher = re.compile(r"^-(\d+\.?\d*|\.\d+)([eE][-+]?\d+)?$")  # -5e-1 is no option
    parser.add_argument("x", type=_finite, help="[m]")
    parser.add_argument("y", type=_finite, help="[m]")
    parser.add_argument("--frame", default="odom", help="of X and Y: odom, map, base_footprint, ... (default odom)")
    parser.add_argument("--robot", default="", help="of many, the name of the one to send; F is given without it")
    parser.add_argument("--world", help="world of the simulator that is started when none runs")
    return parser.parse_args(argv)


def _finite(text: str) -> float:
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if not math.isfinite(value):
        raise argparse.ArgumentTypeError(f"expected a finite number of metres, got {text!r}")
    return value


class _Progress:
    """One line that is written over on a terminal; elsewhere a line for each new message."""

    def __init__(self) -> None:
        self.on_terminal = sys.stdout.isatty()
        self.last = ""

    def show(self, feedback: GoToPositionFeedback) -> None:
        figures = f"distance {feedback.position_error:6.2f} m   angle {feedback.angle_error:+6.2f} rad"
        line = f"{figures}   {feedback.message}"
        if self.on_terminal:
            print("\r\033[K" + line, end="", flush=True)
        else:
            phase = feedback.message.split(",")[0]
            if phase != self.last:
                print(line, flush=True)
            self.last = phase

    def close(self) -> None:
        if self.on_terminal:
            print("\r\033[K", end="")


def _pursue(args: argparse.Namespace, patience: float) -> int:
    """Send the goal to the server and wait for its end."""
    rospy.init_node("robocop_goto", anonymous=True, disable_signals=True)
    started = rospy.get_rostime()
    latest: List[Optional[Odometry]] = [None]
    rospy.Subscriber(_of(args.robot, "odom"), Odometry, lambda message: latest.__setitem__(0, message), queue_size=1)
    transformer = GoalTransformer(_frame(args.robot, "odom"), _frame(args.robot, "odom"), SERVER_PATIENCE,
                                  lambda: latest[0])
    action = _of(args.robot, ACTION)
    client = actionlib.ActionClient(action, GoToPositionAction)
    missing = action_servers.wait_or_explain(client, action, patience)
    check()  # rospy takes any exception for a failure of its own at times
    if missing:
        print(f"robocop goto: {missing}", file=sys.stderr)
        return NOT_REACHED
    pose = PoseStamped()
    pose.header.frame_id = _frame(args.robot, args.frame)
    pose.pose.position = Point(args.x, args.y, 0.0)
    try:
        position = transformer.resolve(pose)
    except FrameError as error:
        check()
        print(f"robocop goto: {error}", file=sys.stderr)
        if rospy.get_rostime() == started:
            print(f"robocop goto: {STANDING}", file=sys.stderr)
        return NOT_REACHED
    return _follow(client, position)


def _of(robot: str, name: str) -> str:
    """A topic of one of many robots; of a lone one, the name as it is."""
    return f"/{robot}/{name}" if robot else name


def _frame(robot: str, frame: str) -> str:
    """A frame that each robot has for itself, of this robot; others, such as map, as they are."""
    return f"{robot}/{frame}" if robot and frame in OWN_FRAMES else frame


def _follow(client: actionlib.ActionClient, position: Point) -> int:
    """Send a position in odom, show feedback, cancel on Ctrl-C."""
    progress = _Progress()
    ending: List[str] = []
    goal: Optional[SentGoal] = None
    standstill = _Standstill()
    try:
        with Deferred():  # what is sent can be cancelled
            goal = SentGoal(client, position, ending.append, progress.show)
        while not goal.done.wait(0.1):
            check()
            standstill.look()
            if not action_servers.is_up(client):
                progress.close()
                print("robocop goto: the server is gone", file=sys.stderr)
                return NOT_REACHED
    except KeyboardInterrupt:
        if goal is None:
            raise
        goal.cancel()
        wait_until(goal.done.is_set, SERVER_PATIENCE)
    progress.close()
    print(ending[0] if ending else "no answer from the server")
    return REACHED if goal.result is not None and goal.result.success else NOT_REACHED


class _Standstill:
    """Says it once when simulated time does not pass."""

    def __init__(self) -> None:
        self.time = rospy.get_rostime()
        self.since = time.monotonic()
        self.said = False

    def look(self) -> None:
        """To be called again and again."""
        now = rospy.get_rostime()
        if now != self.time:
            self.time, self.since, self.said = now, time.monotonic(), False
        elif time.monotonic() - self.since > STANDSTILL_PATIENCE and not self.said:
            self.said = True
            print(f"robocop goto: {STANDING}", file=sys.stderr, flush=True)


def main() -> None:
    """Entry point; exit status 0 reached, 1 not, 2 for arguments of no sense."""
    args = _arguments(rospy.myargv()[1:])
    as_ctrl_c()  # cancel, and end what was started
    try:
        sys.exit(_run(args))
    except KeyboardInterrupt:
        rospy.signal_shutdown("interrupted")
        print("robocop goto: interrupted", file=sys.stderr, flush=True)
        os._exit(NOT_REACHED)  # what was interrupted while it was being made, a tf2 listener say, has no proper end


def _run(args: argparse.Namespace) -> int:
    if master_answers():
        if args.world:
            print("robocop goto: --world is left out, for a system runs already", file=sys.stderr)
        return _pursue(args, SERVER_PATIENCE)
    print("robocop goto: no ROS master answers; starting a headless simulator for this goal", flush=True)
    world = os.path.abspath(args.world) if args.world and os.path.isfile(args.world) else args.world
    log = os.path.join(rospkg.get_ros_home(), "robocop_goto.log")
    status = NOT_REACHED
    with own_system("robocop_goto_as.launch", ["rviz:=false"] + ([f"world:={world}"] if world else []), log) as started:
        if started:
            status = _pursue(args, START_PATIENCE)
    complaints = [line for line in _lines(log) if "[FATAL]" in line]
    if complaints or not started:
        print("\n".join(["robocop goto: the system that was started for this goal failed:", *complaints,
                         f"all that it said is in {log}"]), file=sys.stderr)
    return status


def _lines(log: str) -> List[str]:
    """What a launched system said, without the colours."""
    with open(log, errors="replace") as stream:
        return [re.sub(r"\x1b\[[0-9;]*m", "", line).rstrip() for line in stream]
