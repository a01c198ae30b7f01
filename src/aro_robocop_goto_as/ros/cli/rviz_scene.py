"""The running system -> what RViz is to show of it: only what exists, with a camera that fits the world."""

import time
from typing import Any, Dict, List, Optional, Tuple

import numpy as np
import rosgraph
import rospy
from nav_msgs.msg import MapMetaData
from tf2_msgs.msg import TFMessage
from visualization_msgs.msg import Marker, MarkerArray

from ...geometry import rotation_matrix
from ...process.x_screen import window_area
from ...rviz.camera import Extent
from ...rviz.config import FIXED, WORLD_TOPIC, Scene, Window

ODOM_TF = "/robocop_sim/odom_tf"  # parameter of the simulator
MAP = "map"
FIXED_IN_WORLD = ("world", MAP, "odom")  # frames that do not move with the robot
LARGEST_SIDE = 12.0  # [m] of the part that is shown; in a larger one a robot would be a few pixels
AROUND_ROBOT = Extent((-3.0, -3.0), (3.0, 3.0))
MARGIN = 1.0  # [m] around a robot, whose text is about two metres wide
MESSAGE_TIMEOUT = 5.0  # [s, wall] for a latched message of a topic that is published
STARTS_TIMEOUT = 1.0  # [s, wall] for map -> odom of the robots, which localization:=none does not publish
POLL = 0.05  # [s, wall]
UNIT_CORNERS = np.array([(x, y, z) for x in (-0.5, 0.5) for y in (-0.5, 0.5) for z in (-0.5, 0.5)])


def scene_of(fixed_frame: str, wait: float, server: bool) -> Scene:
    """What the system on ROS_MASTER_URI has, waiting up to `wait` [s] for the simulator to publish its world.

    server: whether the markers of the go-to server are shown, which may start later.
    """
    area = window_area()
    window = Window() if area is None else Window(*area)
    if not rosgraph.is_master_online():
        return Scene(fixed_frame=fixed_frame, window=window, server=server)
    # Not under the name that RViz will have; on the wall clock, as simulated time may not run yet.
    rospy.init_node("robocop_rviz_scene", argv=[], anonymous=True, disable_rostime=True, disable_signals=True)
    try:
        return _observed(fixed_frame, wait, server, window)
    finally:
        rospy.signal_shutdown("RViz starts")


def _observed(fixed_frame: str, wait: float, server: bool, window: Window) -> Scene:
    markers = _world(wait)
    topics = dict(rospy.get_published_topics())
    robot = rospy.get_namespace().strip("/")
    in_world = fixed_frame in FIXED_IN_WORLD or fixed_frame.endswith("/odom")
    # Without odom -> base_footprint, either the world or the robot can be shown, and not what is between them.
    placed = bool(rospy.get_param(ODOM_TF, True)) if markers is not None else True
    extent = _extent(markers, topics, robot) if placed or in_world else AROUND_ROBOT
    return Scene(
        fixed_frame=fixed_frame,
        camera_frame=MAP if in_world and fixed_frame != MAP else FIXED,
        extent=extent,
        window=window,
        grid_map="/map" in topics and (placed or in_world),
        world=placed or in_world,
        model=not robot and (placed or not in_world) and rospy.search_param("robot_description") is not None,
        scan=placed or not in_world,
        trail=placed or in_world,
        axes=(MAP, f"{robot}/odom".lstrip("/")) if placed or in_world else (fixed_frame,),
        server=server,
        image=image_topic(topics, rospy.get_namespace()),
    )


def _world(wait: float) -> Optional[MarkerArray]:
    """The markers of the simulator's world; None if they are not published within `wait` [s]."""
    end = time.monotonic() + wait
    while WORLD_TOPIC not in dict(rospy.get_published_topics()):
        if time.monotonic() >= end:
            return None
        time.sleep(POLL)
    return _message(WORLD_TOPIC, MarkerArray)


def _message(topic: str, kind: Any) -> Any:
    """A latched message; None if there is none."""
    try:
        return rospy.wait_for_message(topic, kind, MESSAGE_TIMEOUT)
    except rospy.ROSException:
        return None


def image_topic(topics: Dict[str, str], namespace: str) -> str:
    """The topic of the robot's colour camera, relative to its namespace; empty if it has none."""
    images = sorted(
        topic[len(namespace) :]
        for topic, kind in topics.items()
        if kind == "sensor_msgs/Image" and topic.startswith(namespace) and "depth" not in topic
    )
    return next((topic for topic in images if "rgb" in topic), images[0] if images else "")


def _extent(markers: Optional[MarkerArray], topics: Dict[str, str], robot: str) -> Extent:
    """Obstacles, or else the map, and where the robots start; of a large world the part around the robot."""
    points = [corners_of(marker) for marker in (markers.markers if markers else [])]
    if not any(map(len, points)) and "/map_metadata" in topics:
        metadata = _message("/map_metadata", MapMetaData)
        points += [] if metadata is None else [map_corners(metadata)]
    starts = _starts() if markers is not None else {}
    here = starts.get(f"{robot}/odom".lstrip("/"), next(iter(starts.values()), None))
    every = np.concatenate([np.zeros((0, 3)), *points])
    if not len(every):
        extent = _around(here or (0.0, 0.0), Extent())
    else:
        low, high = every.min(axis=0), every.max(axis=0)
        extent = Extent((float(low[0]), float(low[1])), (float(high[0]), float(high[1])), max(float(high[2]), 0.0))
    for x, y in starts.values():
        extent = extent.with_point(x, y, MARGIN)
    middle = ((extent.low[0] + extent.high[0]) / 2.0, (extent.low[1] + extent.high[1]) / 2.0)
    return extent.limited(LARGEST_SIDE, *(here or middle))


def _around(place: Tuple[float, float], extent: Extent) -> Extent:
    """An extent around a place [m] instead of around the origin."""
    x, y = place
    return Extent((extent.low[0] + x, extent.low[1] + y), (extent.high[0] + x, extent.high[1] + y), extent.height)


def corners_of(marker: Marker) -> np.ndarray:
    """Corners (n, 3) [m] of the box around an obstacle's marker; (0, 3) for markers that stand for no obstacle."""
    if marker.ns != "world":
        return np.zeros((0, 3))
    if marker.type == Marker.TRIANGLE_LIST:
        corners = np.array([(point.x, point.y, point.z) for point in marker.points]).reshape(-1, 3)
    else:
        corners = UNIT_CORNERS * (marker.scale.x, marker.scale.y, marker.scale.z)
    position, turn = marker.pose.position, marker.pose.orientation
    rotation = rotation_matrix((turn.x, turn.y, turn.z, turn.w))
    return corners @ rotation.T + np.array([position.x, position.y, position.z])


def map_corners(metadata: MapMetaData) -> np.ndarray:
    """Corners (4, 3) [m] of a map."""
    origin, turn = metadata.origin.position, metadata.origin.orientation
    sides = metadata.resolution * np.array([(x, y, 0) for x in (0, metadata.width) for y in (0, metadata.height)])
    rotation = rotation_matrix((turn.x, turn.y, turn.z, turn.w))
    return sides @ rotation.T + np.array([origin.x, origin.y, 0.0])


def _starts() -> Dict[str, Tuple[float, float]]:
    """Each robot's odometry frame and its place x, y [m] in the map, where the robot started."""
    found: List[Tuple[str, float, float]] = []

    def on_transforms(message: TFMessage) -> None:
        found.extend(
            (t.child_frame_id, t.transform.translation.x, t.transform.translation.y)
            for t in message.transforms
            if t.header.frame_id.lstrip("/") == MAP
        )

    subscriber = rospy.Subscriber("/tf_static", TFMessage, on_transforms)
    end = time.monotonic() + STARTS_TIMEOUT
    while not found and time.monotonic() < end:
        time.sleep(POLL)
    subscriber.unregister()
    return {frame: (x, y) for frame, x, y in found}
