"""The robots, drawn from their descriptions where tf says that their links are."""

import xmlrpc.client
from functools import partial
from typing import Dict, Iterable, Optional, Set, Tuple

import rosgraph
import rospy
from geometry_msgs.msg import Transform, TransformStamped, Vector3
from nav_msgs.msg import Odometry
from tf2_msgs.msg import TFMessage

from ...errors import RobotModelError
from ...names import absolute
from ...web.scene import Group, Visual
from ...web.state import PageState
from ...web.urdf import read_links
from ..graph import Topic, published_topics
from .part import Context, Inbox, Part

DESCRIPTION, ODOM = "robot_description", "/odom"
BASES = ("base_footprint", "base_link")  # frames of a robot, the first one that exists
TRANSFORMS = 1000  # messages that wait at most while the ROS master keeps the main thread waiting


class RobotsPart(Part):
    """Also determines the selected robot's pose. The first of the parts, since all others need transforms."""

    def __init__(self, context: Context) -> None:
        super().__init__(context)
        self._links: Dict[str, Dict[str, Visual]] = {}  # by robot and name
        self._moved: Set[str] = set()  # frames with a transform on tf

    def subscribe(self, inbox: Inbox) -> None:
        inbox.subscribe("/tf", TFMessage, self._on_tf, TRANSFORMS)
        inbox.subscribe("/tf_static", TFMessage, partial(self._on_tf, is_static=True), None)

    def subscribe_to_robot(self, inbox: Inbox, robot: str) -> None:
        inbox.subscribe(absolute(robot, "odom"), Odometry, self._on_odometry)

    def _on_odometry(self, _: float, message: Odometry) -> None:
        """Store odometry as a transform, in case nobody publishes this transform, as in the original lab."""
        at, child = message.pose.pose.position, message.child_frame_id
        if child.lstrip("/") not in self._moved:
            motion = Transform(Vector3(at.x, at.y, at.z), message.pose.pose.orientation)
            self.context.frames.update(TransformStamped(message.header, child, motion))

    def _on_tf(self, _: float, message: TFMessage, is_static: bool = False) -> None:
        for stamped in message.transforms:
            self._moved.add(stamped.child_frame_id.lstrip("/"))
            self.context.frames.update(stamped, is_static)

    def show(self, state: PageState) -> None:
        """Draw all robots. If nobody publishes the fixed frame, as without localization, odom takes its place."""
        context = self.context
        known = context.frames.knows(context.fixed_frame)
        context.state.change(root=context.fixed_frame if known else context.frame_of(state.selected, "odom"))
        group: Group = {}
        for robot, links in self._links.items():
            for link, shape in links.items():
                pose = context.locate(context.frame_of(robot, link))
                if pose is not None:
                    group[(robot, link)] = (shape, pose)
        context.scene.show("robots", group)
        poses = (context.locate(context.frame_of(state.selected, base)) for base in BASES)
        context.state.change(pose=next((pose for pose in poses if pose is not None), None))

    def ask_master(self, state: PageState) -> None:
        try:
            robots = robots_of(published_topics()) or ("",)
        except (OSError, rosgraph.MasterException):
            return
        self.context.state.change(robots=robots)
        found = {robot: self._links[robot] if robot in self._links else self._load(robot) for robot in robots}
        self._links = {robot: links for robot, links in found.items() if links is not None}

    def _load(self, robot: str) -> Optional[Dict[str, Visual]]:
        """A robot's links by name, from its own description or one that all share; None as long as there is none."""
        try:
            name = rospy.search_param(absolute(robot, DESCRIPTION)) or f"/{DESCRIPTION}"
            text = rospy.get_param(name, "")
        except (OSError, rosgraph.MasterException, xmlrpc.client.Error):  # the master has just gone
            return None
        if not isinstance(text, str) or not text:
            return None
        try:
            return read_links(text)
        except RobotModelError as error:
            rospy.logwarn_throttle(60.0, "the robot %r is not drawn: %s", robot, error)
            return {}


def robots_of(topics: Iterable[Topic]) -> Tuple[str, ...]:
    """Namespaces of the robots: those with odometry on a topic called odom; "" for a robot without a namespace."""
    odometry = (topic.name for topic in topics if topic.type == "nav_msgs/Odometry" and topic.name.endswith(ODOM))
    return tuple(sorted(name[: -len(ODOM)].lstrip("/") for name in odometry))
