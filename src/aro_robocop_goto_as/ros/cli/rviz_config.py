"""Adapts RViz's configuration, rviz/robocop.rviz, to the running system as it was observed."""

import math
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Dict, Optional, Tuple

import numpy as np
import yaml

from ...names import prefixed
from ...web.page import axes_down, box_corners, view_of
from ..share import share

IN_WORLD = ("world", "map", "odom")  # frames that do not move with the robot
PITCH = 1.05  # [rad] x points to the right, y up the screen, seen steeply from above
FIELD_OF_VIEW = math.radians(45.0)  # [rad] vertical, of every RViz camera: Ogre's default
HEIGHT = 0.5  # [m] of the walls; what is higher may reach out of the view
ROOM = 2.5  # [m] shown on each side of the origin where there are no obstacles
AROUND_ROBOT = 1.0  # [m] its text is about two metres wide
MAX_SIDE = 12.0  # [m] of the part that is shown; in a larger one a robot would be a few pixels
MAX_WINDOW = (1920, 1000)  # [pixel] so that it does not span two monitors
BARS = 80  # [pixel] of the screen's height for panels and the window's title
DOCK_WIDTH, BARS_HEIGHT = 380, 92  # [pixel] of the window that the view does not have, in RViz 1.14
# Added where there is a camera: RViz shows this display's panel even if it is not ticked.
IMAGE: Dict[str, Any] = {
    "Class": "rviz/Image",
    "Name": "Image",
    "Enabled": True,
    "Transport Hint": "raw",
    "Queue Size": 2,
}
Box = Tuple[np.ndarray, np.ndarray]  # low and high corner, each x, y [m]


@dataclass(frozen=True)
class Observed:
    """What is known of the running system when RViz starts."""

    frame: str = "map"  # RViz's Fixed Frame
    robot: str = ""  # whose namespace RViz runs in
    topics: Dict[str, str] = field(default_factory=dict)  # name -> type
    description: bool = True  # whether there is a model of the robot
    odom_tf: bool = True  # whether odom -> base_footprint is published
    server: bool = True  # whether the package's own server is there; its markers include a trail
    obstacles: Optional[np.ndarray] = None  # (n, 2) [m] corners in map; None without a simulator
    start: Tuple[float, float] = (0.0, 0.0)  # [m] of the robot in map
    screen: Tuple[int, int] = (1280, 860)  # [pixel] width, height


def adapted(seen: Observed) -> str:
    """The text of the configuration."""
    config = yaml.safe_load(Path(share(), "rviz", "robocop.rviz").read_text(encoding="utf-8"))
    manager = config["Visualization Manager"]
    displays = {entry["Name"]: entry for entry in manager["Displays"]}
    in_world = seen.frame.rpartition("/")[2] in IN_WORLD
    image = image_topic(seen.topics, f"/{seen.robot}/".replace("//", "/"))
    odom = prefixed(seen.robot, "odom")

    # A robot that has a name is one of the world's markers.
    shown = {"Map": "/map" in seen.topics, "Robot": seen.description and not seen.robot, "Trail": not seen.server}
    if not seen.odom_tf:  # either the world or the robot can be shown, and not what is between them
        hidden = ("Robot", "Scan") if in_world else ("World", "Trail", "Map", "Frame map")
        shown.update(dict.fromkeys(hidden, False))
    for name, is_shown in shown.items():
        displays[name]["Enabled"] = is_shown
    if image:
        manager["Displays"].append({**IMAGE, "Image Topic": image})
        config["Window Geometry"]["Image"] = {"collapsed": False}
    reference = odom if in_world or seen.odom_tf else seen.frame
    displays["Frame odom"].update({"Name": f"Frame {reference}", "Reference Frame": reference})

    width, height = min(seen.screen[0], MAX_WINDOW[0]), min(seen.screen[1] - BARS, MAX_WINDOW[1])
    config["Window Geometry"].update({"Width": width, "Height": height})

    box, target = (np.full(2, -ROOM), np.full(2, ROOM)), "<Fixed Frame>"
    if in_world and seen.obstacles is not None:
        box, target = world_box(seen.obstacles, seen.start), "map"
    distance, x, y = camera(box, (width - DOCK_WIDTH) / max(height - BARS_HEIGHT, 1))
    view = manager["Views"]["Current"]
    view.update({"Distance": round(distance, 3), "Target Frame": target})
    view["Focal Point"].update({"X": round(x, 3), "Y": round(y, 3)})
    return str(yaml.safe_dump(config, sort_keys=False))


def image_topic(topics: Dict[str, str], namespace: str) -> str:
    """The topic of the robot's colour camera, relative to its namespace; empty if it has none."""
    images = sorted(
        topic[len(namespace) :]
        for topic, kind in topics.items()
        if kind == "sensor_msgs/Image" and topic.startswith(namespace) and "depth" not in topic
    )
    return next((topic for topic in images if "rgb" in topic), images[0] if images else "")


def world_box(obstacles: np.ndarray, start: Tuple[float, float]) -> Box:
    """The part of the world to show: obstacles (n, 2) [m] and the robot; of a large world the part around the robot."""
    robot = np.array(start)
    margin = AROUND_ROBOT if len(obstacles) else ROOM
    points = np.vstack([obstacles, robot - margin, robot + margin])
    low, high = points.min(axis=0), points.max(axis=0)
    half = np.minimum(high - low, MAX_SIDE) / 2.0
    middle = np.clip(robot, low + half, high - half)
    return middle - half, middle + half


def camera(box: Box, aspect: float) -> Tuple[float, float, float]:
    """Distance and focal point x, y [m] of the orbit camera that just shows a box in a view of this width / height."""
    axes = axes_down(math.sin(PITCH))
    position, focus = view_of(box_corners(*box, HEIGHT), max(aspect, 0.1), axes, FIELD_OF_VIEW)
    return float(np.linalg.norm(position - focus)), float(focus[0]), float(focus[1])
