"""The run shown in RViz at real time, on topics of its own: the submission meets the same topics, frames and log.

RViz and its robot_state_publisher are processes of the probe, as the ROS master can be reached from there only. What
they need beyond /scan, /odom and /clock goes to /robocop_watch: a submission that asks TF for the lidar's frame has to
fail watched as it fails unwatched.
"""

import math
import subprocess
import textwrap
import time
from pathlib import Path
from typing import List, Optional, Sequence

import rospkg
import rospy
from geometry_msgs.msg import Point, TransformStamped
from sensor_msgs.msg import JointState
from std_msgs.msg import ColorRGBA
from tf2_msgs.msg import TFMessage
from visualization_msgs.msg import Marker, MarkerArray

from ...goto import Goal
from ...models import load_model
from ...nodes import convert
from ...nodes.markers import circle_marker, following, goal_markers, removed, text_marker
from ...nodes.publishing import publisher
from ...nodes.robot_topics import RobotTopics
from ...nodes.world_markers import world_markers
from ...simulator import Observations
from .. import record as rec
from ..plan import Plan, world_of

OPEN_PATIENCE = 60.0  # [s, wall] for RViz to show itself; with a software renderer on a busy machine it takes ten
CLOSE_PATIENCE = 2.0  # [s, wall]
POLL = 0.05  # [s, wall]
OWN = "/robocop_watch"
TOPICS = ("tf", "tf_static")
WAY_COLOR = ColorRGBA(0.35, 0.78, 0.98, 0.9)
WAY_STEP = 0.01  # [m]
CLICK_COLOR = ColorRGBA(1.0, 0.75, 0.1, 0.9)
CLICK_RADIUS = 0.2  # [m] wider than the goal's circle, so that both are seen where they belong: in one place
TEXT_SIZE, TEXT_HEIGHT = 0.08, 1.5  # [m] of its letters, and above the floor: what is near ahead stays in view
COME_AND_GO = ("way", "goal_circle", "goal_pin", "click")  # namespaces of markers
TEXT_WIDTH = 44  # characters of a line
LOG_LINES = 5


class WatchError(Exception):
    """RViz can't be opened; the text says why."""


class Watch:
    """RViz, what is drawn in it, and the pace. When its window is closed the run goes on, as fast as without it."""

    def __init__(self, robot: RobotTopics, plan: Plan, log: Path) -> None:
        self.slept = 0.0  # [s, wall] for RViz to open, and to keep to real time
        self._said = 0.0
        self._robot = robot
        self._plan = plan
        self._log = log
        self._period = 1.0 / robot.p.clock_rate
        self._latest = 0.0  # [s, wall] when the clock ticked
        self._processes: List[subprocess.Popen[bytes]] = []
        self._rviz: Optional[subprocess.Popen[bytes]] = None
        self._way: List[Point] = []
        self._tf = publisher(f"{OWN}/tf", TFMessage)
        self._tf_static = publisher(f"{OWN}/tf_static", TFMessage, latch=True)
        self._joints = publisher(f"{OWN}/joint_states", JointState)
        self._scene = publisher(f"{OWN}/scene", MarkerArray)
        self._obstacles = world_markers(world_of(plan), robot.p.world_frame, 0.0)
        self._text = text_marker("scenario", "", robot.base_frame)

    def open(self) -> None:
        """Start RViz, and wait until it listens to all that it is to show; WatchError when it does not."""
        share = rospkg.RosPack().get_path("aro_robocop_goto_as")
        rospy.set_param(f"{OWN}/robot_description", load_model(self._robot.p.model, share).urdf)
        self._start("robot_state_publisher", "robot_state_publisher", "frames")
        self._rviz = self._start("rviz", "rviz", "rviz", "-d", f"{share}/rviz/grading_watch.rviz")
        started = time.monotonic()
        while not all(topic.get_num_connections() for topic in self._shown()):
            if self._rviz.poll() is not None:
                raise WatchError(f"RViz ended as it came up (status {self._rviz.returncode}): {self._last()}")
            if time.monotonic() - started > OPEN_PATIENCE:
                raise WatchError(f"RViz did not come up within {OPEN_PATIENCE:g} s: {self._last()}")
            time.sleep(POLL)
        self._count(time.monotonic() - started)

    def _shown(self) -> Sequence[rospy.Publisher]:
        """Topics that somebody has to listen to: RViz, and robot_state_publisher to the last."""
        return self._robot.scan, self._robot.odom, self._tf, self._tf_static, self._scene, self._joints

    def _start(self, package: str, program: str, name: str, *arguments: str) -> "subprocess.Popen[bytes]":
        """A node of this process group, all of whose topics but those of the simulator are our own.

        Its log as well: a line of RViz's is not the submission's, nor is its connection a sign of life.
        """
        renamed = [f"/{topic}:={OWN}/{topic}" for topic in TOPICS]
        command = ["rosrun", package, program, *arguments, *renamed, f"/rosout:={OWN}/log", f"__ns:={OWN}",
                   f"__name:={name}"]
        with open(self._log, "ab") as log:
            process = subprocess.Popen(command, stdin=subprocess.DEVNULL, stdout=log, stderr=log)
        self._processes.append(process)
        return process

    def _last(self) -> str:
        lines = self._log.read_text(errors="replace").splitlines()
        return " | ".join(line.strip() for line in lines[-LOG_LINES:])

    @property
    def open_still(self) -> bool:
        """Whether there is still an RViz."""
        return self._rviz is not None and self._rviz.poll() is None

    def close(self) -> None:
        """End RViz and its helper."""
        for process in self._processes:
            process.terminate()
        for process in self._processes:
            try:
                process.wait(CLOSE_PATIENCE)
            except subprocess.TimeoutExpired:
                process.kill()

    # -- what happens, told by the stage and the run --

    def begin(self, name: str, about: str) -> None:
        """A scenario: its name and a sentence go above the robot, and its way starts."""
        self._way = []
        text = "\n".join([name, *textwrap.wrap(about.strip().rstrip("."), TEXT_WIDTH)])
        self._text = text_marker("scenario", text, self._robot.base_frame)
        self._text.scale.z, self._text.pose.position.z = TEXT_SIZE, TEXT_HEIGHT

    def saw(self, seen: Observations, real_time: bool) -> None:
        """What a step brought, before it is published; at real time it waits until the clock's next tick is due."""
        if not self.open_still:
            return
        if seen.clock:
            ahead = self._latest + self._period - time.monotonic()
            if real_time and ahead > 0.0:
                time.sleep(ahead)
                self._count(ahead)
            self._latest = time.monotonic()
        if seen.joints is not None:
            wheels = seen.joints[0]
            self._joints.publish(convert.to_joint_state(wheels.wheel_angles, wheels.wheel_velocities,
                                                        convert.to_time(seen.stamp_ns)))

    def moves(self, transforms: List[TransformStamped]) -> None:
        """Transforms that change all the time."""
        self._tf.publish(transforms)

    def stands(self, transforms: List[TransformStamped]) -> None:
        """Transforms from now on."""
        self._tf_static.publish(transforms)

    def show(self, sample: rec.Sample, goals: Sequence[rec.Goal], clicks: Sequence[rec.Click]) -> None:
        """Obstacles, the way so far, the newest goal and the newest click.

        All of it each time, and what is not there taken away each time: RViz never comes back to a marker whose frame
        it did not know when it came, and may put one up that came shortly before it was taken away.
        """
        frame = self._robot.odom_frame
        if not self._way or math.hypot(sample.x - self._way[-1].x, sample.y - self._way[-1].y) > WAY_STEP:
            self._way.append(Point(sample.x, sample.y, 0.01))
        way = following("way", Marker.LINE_STRIP, frame, WAY_COLOR)
        way.scale.x, way.points = 0.02, self._way
        found = [*self._obstacles, self._text]
        if len(self._way) > 1:
            found.append(way)
        for goal in goals[-1:]:
            found += goal_markers(self._plan.limits.reached, Goal(goal.x, goal.y), frame)
        for click in clicks[-1:]:
            found.append(circle_marker("click", CLICK_RADIUS, Goal(click.odom_x, click.odom_y), frame, CLICK_COLOR))
        there = {marker.ns for marker in found}
        self._scene.publish(found + [removed(namespace) for namespace in COME_AND_GO if namespace not in there])

    def _count(self, seconds: float) -> None:
        """Time that is nobody's fault: said in whole seconds to the grader outside, which has a deadline too."""
        self.slept += seconds
        if self.slept - self._said >= 1.0:
            print(f"slept {self.slept - self._said:.3f}", flush=True)
            self._said = self.slept
