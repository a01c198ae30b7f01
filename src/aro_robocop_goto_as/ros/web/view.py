"""From what was received to what the page shows; everything here runs in the node's main thread."""

import time
import xmlrpc.client
from typing import Any, Dict, Optional, Tuple

import numpy as np
import rosgraph
import rospkg
import rospy

from ...errors import RobotModelError
from ...geometry import Pose3D, compose3
from ...web import urdf
from ...web.page import Page
from ...web.scene import TRAIL_HEIGHT, Scene
from ...web.trail import Trail
from .images import camera_image, map_image, scan_points
from .marker_shapes import MarkerStore, to_pose
from .topics import GoalTopics, RobotTopics, SystemTopics, absolute

DESCRIPTION, PREFIX = "robot_description", "robocop_state_publisher/tf_prefix"
BASES = ("base_footprint", "base_link")  # frames of a robot, the first one that exists
SLOW_PERIOD = 1.0  # [s, wall] between two updates of what changes rarely
PLOT_PERIOD = 0.25  # [s, wall]
DRAWN_BY_SCENE = ("robots", "noses")  # markers of the simulator that stand for robots whose model is drawn


class View:
    """The newest state of everything that is received while a browser shows the page."""

    def __init__(
        self, page: Page, scene: Scene, fixed_frame: str, packages: rospkg.RosPack, replayed: bool = False
    ) -> None:
        """`replayed`: a recording is shown, whose simulator may be silent for as long as it is paused."""
        self._replayed = replayed
        self.system = SystemTopics()
        self.goals = GoalTopics()
        self.robot_pose: Optional[Pose3D] = None  # of the selected robot, in the fixed frame
        self._robot = RobotTopics("")
        self._page = page
        self._scene = scene
        self._fixed_frame = fixed_frame
        self._packages = packages
        self._world, self._server = MarkerStore(), MarkerStore()
        self._trail = Trail()
        self._trail_frame = ""
        self._links: Dict[str, Dict[str, str]] = {}  # frame of each link of each robot
        self._shown: Dict[str, Any] = {"scan": None, "map": None, "image": None}
        self._connected_at = self._slow_at = self._plot_at = 0.0
        self._opened = False

    def connect(self, robots: Tuple[str, ...], selected: str) -> None:
        """Subscribe, and read the descriptions of new robots. Only this needs the ROS master, and may wait for it."""
        if not self._opened:
            self._opened = True
            self._world.clear()
            self._server.clear()
            self.system.open()
            self._robot.open()
        if selected != self._robot.robot:
            self._select(selected)
        now = time.monotonic()
        if now - self._connected_at >= SLOW_PERIOD:
            self._connected_at = now
            self.watch_goals(robots)
            for robot in set(robots) - set(self._links):
                self._load(robot)

    def close(self) -> None:
        """Unsubscribe."""
        if self._opened:
            self._opened = False
            self.system.close()
            self._robot.close()

    def watch_goals(self, robots: Tuple[str, ...]) -> None:
        """Keep the history of these robots' goals."""
        self.goals.watch(robots)

    def forget(self) -> None:
        """Another moment of a recording is shown: trail, plots and history begin anew."""
        self.goals.history.clear()
        self._robot.errors.clear()
        self._robot.commands.clear()
        self._trail_frame = ""

    @property
    def executing(self) -> bool:
        """Whether the selected robot's server executes a goal."""
        return self._robot.feedback(time.monotonic()) is not None

    def update(self, robots: Tuple[str, ...], answer: str) -> None:
        """Show the newest state; nothing before the first `connect`."""
        if not self._opened:
            return
        now = time.monotonic()
        self._show_robots(robots)
        self._show_markers()
        self._show_scan()
        self._show_panel(robots, now, answer)
        if now - self._slow_at >= SLOW_PERIOD:
            self._slow_at = now
            self._show_map()
            self._page.show_history(self.goals.history.latest(), len(robots) > 1)

    def _select(self, robot: str) -> None:
        self._robot.close()
        self._robot = RobotTopics(robot)
        self._robot.open()
        self._server.clear()
        self._trail.clear()
        self._scene.show_trail(self._trail.segments(TRAIL_HEIGHT))
        self._scene.show_scan(np.zeros((0, 3)))
        self._page.show_image(None)

    def _lookup(self, frame: str) -> Optional[Pose3D]:
        """fixed_from_frame; where nobody publishes the fixed frame, as without localization, frames are as in odom."""
        return self.system.frames.lookup(self._root(), frame)

    def _root(self) -> str:
        frames = self.system.frames
        if frames.knows(self._fixed_frame):
            return self._fixed_frame
        return self._frame_of(self._robot.robot, "odom")

    def _frame_of(self, robot: str, link: str) -> str:
        """A link's frame, which has the robot's name as a prefix if there are several robots."""
        prefixed = f"{robot}/{link}"
        return prefixed if robot and self.system.frames.knows(prefixed) else link

    # -- robots --

    def _show_robots(self, robots: Tuple[str, ...]) -> None:
        for robot in set(self._links) - set(robots):
            self._scene.remove_robot(robot)
            del self._links[robot]
        for robot, links in self._links.items():
            pose = self._base_pose(robot)
            if robot == self._robot.robot:
                self.robot_pose = pose
            for link, frame in links.items():
                self._scene.place_link(robot, link, self._lookup(frame))
        self._page.follow(self.robot_pose)
        self._show_trail()
        frames = self.system.frames.names() if self._page.shows_frames else []
        poses = {frame: self._lookup(frame) for frame in frames}
        self._scene.show_frames({frame: pose for frame, pose in poses.items() if pose is not None})

    def _base_pose(self, robot: str) -> Optional[Pose3D]:
        for base in BASES:
            pose = self._lookup(self._frame_of(robot, base))
            if pose is not None:
                return pose
        return None

    def _load(self, robot: str) -> None:
        """Read a robot's description, its own or one that all share; until there is one, nothing is drawn."""
        try:
            name = rospy.search_param(absolute(robot, DESCRIPTION))
            text = rospy.get_param(name, "") if name else rospy.get_param(f"/{DESCRIPTION}", "")
        except (OSError, rosgraph.MasterException, xmlrpc.client.Error):  # the master has just gone
            return
        if not isinstance(text, str) or not text:
            return
        try:
            links = {link: shapes for link, shapes in urdf.read_links(text, self._find_mesh).items() if shapes}
        except RobotModelError as error:
            rospy.logwarn_throttle(60.0, "the robot %r is not drawn: %s", robot, error)
            links = {}
        self._links[robot] = {link: self._frame_of(robot, link) for link in links}
        self._scene.set_robot(robot, links)

    def _find_mesh(self, uri: str) -> Optional[str]:
        """The file of a mesh: package://NAME/PATH or file:///PATH."""
        scheme, _, path = uri.partition("://")
        if scheme == "file":
            return path
        if scheme != "package":
            return None
        package, _, path = path.partition("/")
        try:
            return f"{self._packages.get_path(package)}/{path}"
        except rospkg.ResourceNotFound:
            return None

    def _show_trail(self) -> None:
        if not self._page.shows_trail or self._trail_frame != self._root():
            self._trail_frame = self._root()
            self._trail.clear()
            self._scene.show_trail(self._trail.segments(TRAIL_HEIGHT))
        elif self.robot_pose is not None and self._trail.add(*self.robot_pose.position[:2]):
            self._scene.show_trail(self._trail.segments(TRAIL_HEIGHT))

    # -- markers, scan, map --

    def _show_markers(self) -> None:
        for queue, store in ((self.system.markers, self._world), (self._robot.markers, self._server)):
            while queue:
                store.apply(queue.popleft())
        self._scene.show_group("world", self._world.placed(self._lookup, DRAWN_BY_SCENE if self._links else ()))
        self._scene.show_group("server", self._server.placed(self._lookup))

    def _show_scan(self) -> None:
        scan = self._robot.scan
        if scan is not self._shown["scan"]:
            pose = None if scan is None else self._lookup(scan.header.frame_id.lstrip("/"))
            if scan is not None and pose is not None:
                self._shown["scan"] = scan
                self._scene.show_scan(scan_points(scan, pose))

    def _show_map(self) -> None:
        message = self.system.map
        if message is self._shown["map"] or message is None:
            return
        info = message.info
        pose = self._lookup(message.header.frame_id.lstrip("/"))
        origin = to_pose(info.origin.position, info.origin.orientation)
        if pose is None or origin is None or not info.width or len(message.data) != info.width * info.height:
            return
        self._shown["map"] = message
        width, height = info.width * info.resolution, info.height * info.resolution
        half = Pose3D((width / 2.0, height / 2.0, 0.0))
        centre = compose3(compose3(pose, origin), half)
        self._scene.show_map(map_image(message.data, info.width, info.height), width, height, centre)

    # -- the panel --

    def _show_panel(self, robots: Tuple[str, ...], now: float, answer: str) -> None:
        sim = self.system.sim
        silence = 0.0 if sim is None or self._replayed else sim.silent_for(now)
        self._page.show_alert(f"No report from the simulator for {silence:.0f} s: has it ended?" if silence else "")
        self._page.show_answer(answer)
        self._page.show_robots(robots, self._robot.robot)
        self._page.show_sim(sim, len(robots), self._robot.bridge)
        self._page.show_feedback(self._robot.feedback(now))
        if now - self._plot_at >= PLOT_PERIOD:
            self._plot_at = now
            self._page.show_plots(self._robot.errors, self._robot.commands, now)
            image = self._robot.image
            if image is not self._shown["image"]:
                self._shown["image"] = image
                self._page.show_image(None if image is None else camera_image(image))
