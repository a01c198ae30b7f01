"""Shows a run in RViz at real time, on separate topics: the submission sees the same topics, frames and log.

RViz and its robot_state_publisher are children of the probe, as only the probe's network has the ROS master. What they
need beyond /scan, /odom and /clock is published below /robocop_watch: a submission that looks up the lidar's frame in
TF, which is not there, has to fail whether or not it is watched.
"""

import math
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

from ...errors import WatchError
from ...params import SimParams
from ...process import child
from ...robot.catalog import load_model
from ...ros import convert, markers
from ...ros.publishing import publisher
from ...ros.sim.robot_topics import RobotTopics
from ...ros.sim.world_markers import world_markers
from ...rviz.config import WATCH, Window, grading_watch
from ...simulation.observations import Observations
from .. import record as rec
from ..plan import Plan, world_of

OPEN_TIMEOUT = 60.0  # [s, wall] for RViz to come up; with a software renderer on a busy machine it takes ten
POLL = 0.05  # [s, wall]
NAMESPACE = WATCH
TOPICS = ("tf", "tf_static")
PATH_COLOR = ColorRGBA(0.35, 0.78, 0.98, 0.9)
PATH_STEP = 0.01  # [m]
CLICK_COLOR = ColorRGBA(1.0, 0.75, 0.1, 0.9)
CLICK_RADIUS = 0.2  # [m] wider than the goal's circle, so that both are visible when they coincide
TEXT_SIZE, TEXT_HEIGHT = 0.08, 1.5  # [m] of the letters, and above the floor, where it hides nothing
WINDOW = Window(40, 10)
TEMPORARY = ("path", "goal_circle", "goal_pin", "click")  # namespaces of markers
TEXT_WIDTH = 44  # characters of a line
LOG_LINES = 5


class Watch:
    """RViz, what it shows, and the pace. When its window is closed the run continues as fast as without it."""

    def __init__(self, robot: RobotTopics, params: SimParams, plan: Plan, log: Path) -> None:
        self.slept = 0.0  # [s, wall] spent on opening RViz and on keeping to real time
        self._reported = 0.0  # [s, wall] of it
        self._robot = robot
        self._model = params.model
        self._plan = plan
        self._log = log
        self._period = 1.0 / params.clock_rate
        self._last_tick = 0.0  # [s, wall] of the clock
        self._processes: List[child.Child[bytes]] = []
        self._rviz: Optional[child.Child[bytes]] = None
        self._path: List[Point] = []
        self._tf = publisher(f"{NAMESPACE}/tf", TFMessage)
        self._tf_static = publisher(f"{NAMESPACE}/tf_static", TFMessage, latch=True)
        self._joints = publisher(f"{NAMESPACE}/joint_states", JointState)
        self._scene = publisher(f"{NAMESPACE}/scene", MarkerArray)
        self._obstacles = world_markers(world_of(plan), params.world_frame, 0.0)
        self._text = markers.text("scenario", "", robot.footprint_frame)

    def open(self) -> None:
        """Start RViz, and wait until it has subscribed to everything it shows; WatchError if it does not."""
        share = rospkg.RosPack().get_path("aro_robocop_goto_as")
        rospy.set_param(f"{NAMESPACE}/robot_description", load_model(self._model, share).urdf)
        self._start("robot_state_publisher", "robot_state_publisher", "frames")
        again = f"{share}/launch/restart_after_crash"
        config = self._log.with_suffix(".rviz")
        config.write_text(grading_watch(WINDOW))
        self._rviz = self._start("rviz", "rviz", "rviz", "-d", str(config), prefix=[again])
        started = time.monotonic()
        while not all(topic.get_num_connections() for topic in self._shown()):
            if self._rviz.poll() is not None:
                raise WatchError(f"RViz ended at its start (status {self._rviz.returncode}): {self._last_lines()}")
            if time.monotonic() - started > OPEN_TIMEOUT:
                raise WatchError(f"RViz did not come up within {OPEN_TIMEOUT:g} s: {self._last_lines()}")
            time.sleep(POLL)
        self._count(time.monotonic() - started)

    def _shown(self) -> Sequence[rospy.Publisher]:
        """The topics that RViz subscribes to, and last the one of robot_state_publisher."""
        return self._robot.scan, self._robot.odom, self._tf, self._tf_static, self._scene, self._joints

    def _start(
        self, package: str, program: str, name: str, *arguments: str, prefix: Sequence[str] = ()
    ) -> "child.Child[bytes]":
        """Start a node in the probe's session, with all topics but the simulator's in this namespace.

        The log too: lines logged by RViz, or its connection to /rosout, must not be taken for the submission's.
        """
        renamed = [f"/{topic}:={NAMESPACE}/{topic}" for topic in TOPICS]
        command = [
            *prefix,
            "rosrun",
            package,
            program,
            *arguments,
            *renamed,
            f"/rosout:={NAMESPACE}/log",
            f"__ns:={NAMESPACE}",
            f"__name:={name}",
        ]
        with open(self._log, "ab") as log:
            process = child.start(command, stdout=log, stderr=log, start_new_session=False)
        self._processes.append(process)
        return process

    def _last_lines(self) -> str:
        lines = self._log.read_text(errors="replace").splitlines()
        return " | ".join(line.strip() for line in lines[-LOG_LINES:])

    @property
    def is_open(self) -> bool:
        """Whether RViz is running."""
        return self._rviz is not None and self._rviz.poll() is None

    def close(self) -> None:
        """End RViz and robot_state_publisher."""
        for process in self._processes:
            child.end(process, None, grace=0.0)  # no cleanup needed

    # -- called by the stage and the run --

    def begin(self, name: str, about: str) -> None:
        """Start a scenario: show its name and description above the robot, and start a new path."""
        self._path = []
        text = "\n".join([name, *textwrap.wrap(about.strip().rstrip("."), TEXT_WIDTH)])
        self._text = markers.text("scenario", text, self._robot.footprint_frame)
        self._text.scale.z, self._text.pose.position.z = TEXT_SIZE, TEXT_HEIGHT

    def observe(self, seen: Observations, real_time: bool) -> None:
        """Called with a step's observations before they are published; at real time it waits for the next tick."""
        if not self.is_open:
            return
        if seen.clock:
            ahead = self._last_tick + self._period - time.monotonic()
            if real_time and ahead > 0.0:
                time.sleep(ahead)
                self._count(ahead)
            self._last_tick = time.monotonic()
        if 0 in seen.joints:
            wheels = seen.joints[0]
            self._joints.publish(
                convert.to_joint_state(wheels.wheel_angles, wheels.wheel_velocities, convert.to_time(seen.stamp_ns))
            )

    def publish_transforms(self, transforms: Sequence[TransformStamped]) -> None:
        """Publish transforms."""
        self._tf.publish(transforms)

    def publish_static(self, transforms: Sequence[TransformStamped]) -> None:
        """Publish static transforms."""
        self._tf_static.publish(transforms)

    def show(self, sample: rec.Sample, goals: Sequence[rec.Goal], clicks: Sequence[rec.Click]) -> None:
        """Show obstacles, the path so far, the newest goal and the newest click.

        All markers are sent every time, and absent ones deleted every time: RViz drops a marker whose frame it does not
        know yet for good, and may add one that arrived shortly before its deletion.
        """
        frame = self._robot.odom_frame
        if not self._path or math.hypot(sample.x - self._path[-1].x, sample.y - self._path[-1].y) > PATH_STEP:
            self._path.append(Point(sample.x, sample.y, 0.01))
        path = markers.marker("path", Marker.LINE_STRIP, frame, PATH_COLOR)
        path.scale.x, path.points = 0.02, self._path
        shown = [*self._obstacles, self._text]
        if len(self._path) > 1:
            shown.append(path)
        for goal in goals[-1:]:
            shown += markers.goal(self._plan.limits.reached, goal.x, goal.y, frame)
        for click in clicks[-1:]:
            shown.append(markers.circle("click", CLICK_RADIUS, click.odom_x, click.odom_y, frame, CLICK_COLOR))
        present = {marker.ns for marker in shown}
        self._scene.publish(
            shown + [markers.deletion(namespace) for namespace in TEMPORARY if namespace not in present]
        )

    def _count(self, seconds: float) -> None:
        """Add time that must not count as the submission's, and report whole seconds to the grader's deadline."""
        self.slept += seconds
        if self.slept - self._reported >= 1.0:
            print(f"slept {self.slept - self._reported:.3f}", flush=True)
            self._reported = self.slept
