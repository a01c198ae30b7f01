"""Shows a run at real time, on a ROS master of its own: the submission meets the same as in any other run."""

import math
import os
import textwrap
import time
from pathlib import Path
from typing import Any, Dict, List, Sequence
from urllib.parse import urlparse

import rospy
from aro_robocop_goto_as.msg import GoToPositionActionFeedback, GoToPositionActionGoal, GoToPositionActionResult
from geometry_msgs.msg import Point, Twist
from std_msgs.msg import ColorRGBA
from visualization_msgs.msg import Marker, MarkerArray

from aro_robocop_goto_as.errors import WatchError
from aro_robocop_goto_as.process import child
from aro_robocop_goto_as.robot.catalog import load_model
from aro_robocop_goto_as.ros import markers
from aro_robocop_goto_as.ros.publishing.publisher import publisher
from aro_robocop_goto_as.ros.share import share
from aro_robocop_goto_as.ros.sim.step_topics import StepTopics
from aro_robocop_goto_as.ros.sim.world_markers import world_markers
from aro_robocop_goto_as.sensors.lidar import SCAN
from aro_robocop_goto_as.sensors.odometry import JOINTS, ODOM
from aro_robocop_goto_as.sim_params import SimParams
from aro_robocop_goto_as.simulation.observations import Observations

from .. import record as rec
from ..handout import ACTION
from ..plan import Plan, world_of
from ..viewer import Viewer
from .display import Display

DISPLAY_TIMEOUT = (
    60.0  # [s, wall] for RViz to come up, ten on a busy machine without a GPU; and for a browser to be opened
)
AWAY = 10.0  # [s, wall] without a browser, after which the run continues at full speed; a reload takes one or two
POLL = 0.05  # [s, wall]
PATH_COLOR = ColorRGBA(0.35, 0.78, 0.98, 0.9)
PATH_STEP = 0.01  # [m]
CLICK_COLOR = ColorRGBA(1.0, 0.75, 0.1, 0.9)
CLICK_RADIUS = 0.2  # [m] wider than the goal's circle, so that both are visible when they coincide
TEXT_SIZE, TEXT_HEIGHT = 0.08, 1.5  # [m] of the letters, and above the floor, where it hides nothing
TEMPORARY = ("path", "goal_circle", "goal_pin", "click")  # namespaces of markers
TEXT_WIDTH = 44  # characters of a line
SCENE = "/robocop_sim/world"
FORWARDED = {
    "/cmd_vel": Twist,
    f"{ACTION}/goal": GoToPositionActionGoal,
    f"{ACTION}/feedback": GoToPositionActionFeedback,
    f"{ACTION}/result": GoToPositionActionResult,
}


def begin_to_publish() -> None:
    """Become a node of a ROS master of its own, which only the viewer knows; it ends with this process."""
    port = str(urlparse(os.environ["ROS_MASTER_URI"]).port)
    child.start(["rosmaster", "--core", "-p", port], start_new_session=False)
    rospy.init_node("robocop_sim", disable_rosout=True, disable_rostime=True, disable_signals=True, argv=[])
    rospy.set_param("/use_sim_time", True)


class Watch:
    """The viewer, what it shows, and the pace. When it is closed the run continues as fast as without it."""

    def __init__(self, topics: StepTopics, params: SimParams, plan: Plan, viewer: Viewer, log: Path) -> None:
        """`topics`: of the steps, which the owner publishes."""
        self._topics, self._robot = topics, topics.robots[0]
        self._plan = plan
        self._period = 1.0 / params.rates.clock_rate
        self._last_tick = 0.0  # [s, wall] of the clock
        self._seen = 0.0  # [s, wall] when a browser was last found to show the page
        self._path: List[Point] = []
        self._scene = publisher(SCENE, MarkerArray)
        self._forwarded: Dict[str, rospy.Publisher] = {}
        if viewer.is_page:
            self._forwarded = {topic: publisher(topic, kind) for topic, kind in FORWARDED.items()}
        rospy.set_param("/robot_description", load_model(params.robots.model, share()).urdf)
        self._display = Display(viewer, share(), log)
        self._obstacles = world_markers(world_of(plan), params.frames.world_frame, 0.0)
        self._text = markers.text("scenario", "", self._robot.footprint_frame)

    def open(self) -> None:
        """Start the viewer, and wait until it has subscribed to everything it shows.

        WatchError if it does not. The page does so when a browser is opened, and is waited for as long.
        """
        self._display.start()
        started = time.monotonic()
        while not all(topic.get_num_connections() for topic in self._shown()):
            if not self._display.runs:
                raise WatchError(self._display.end)
            if time.monotonic() - started > DISPLAY_TIMEOUT:
                if self._display.is_page:
                    break
                raise WatchError(f"{self._display.name} did not come up within {DISPLAY_TIMEOUT:g} s")
            time.sleep(POLL)
        self._seen = time.monotonic()

    def _shown(self) -> Sequence[rospy.Publisher]:
        """The topics that the viewer subscribes to, and last the one of robot_state_publisher."""
        only_rviz = () if self._display.is_page else (self._robot.topics[ODOM],)
        topics = self._robot.topics
        return topics[SCAN], *only_rviz, self._topics.tf, self._topics.tf_static, self._scene, topics[JOINTS]

    @property
    def is_open(self) -> bool:
        """Return whether RViz is running, or a browser shows the page."""
        if not self._display.is_page:
            return self._display.runs
        if self._scene.get_num_connections():
            self._seen = time.monotonic()
        return time.monotonic() - self._seen < AWAY

    def close(self) -> None:
        """End the viewer."""
        self._display.close()

    # -- called by the stage and the run --

    def begin(self, name: str, about: str) -> None:
        """Start a scenario: show its name and description above the robot, and start a new path."""
        self._path = []
        text = "\n".join([name, *textwrap.wrap(about.strip().rstrip("."), TEXT_WIDTH)])
        self._text = markers.text("scenario", text, self._robot.footprint_frame)
        self._text.scale.z, self._text.pose.position.z = TEXT_SIZE, TEXT_HEIGHT

    def observe(self, seen: Observations, real_time: bool) -> None:
        """Publish a step's observations; at real time, wait for the next tick before."""
        if seen.due.clock and self.is_open:
            ahead = self._last_tick + self._period - time.monotonic()
            if real_time and ahead > 0.0:
                time.sleep(ahead)
            self._last_tick = time.monotonic()
        self._topics.publish(seen)

    def forward(self, topic: str, message: Any) -> None:
        """Show a message of the submission, or one that it gets, in the page."""
        if topic in self._forwarded:
            self._forwarded[topic].publish(message)

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
        present = [*self._obstacles, self._text]
        if len(self._path) > 1:
            present.append(path)
        for goal in goals[-1:]:
            present += markers.goal(self._plan.limits.reached, goal.x, goal.y, frame)
        for click in clicks[-1:]:
            present.append(markers.circle("click", CLICK_RADIUS, click.odom_x, click.odom_y, frame, CLICK_COLOR))
        namespaces = {marker.ns for marker in present}
        absent = [namespace for namespace in TEMPORARY if namespace not in namespaces]
        self._scene.publish(present + [markers.deletion(namespace) for namespace in absent])
