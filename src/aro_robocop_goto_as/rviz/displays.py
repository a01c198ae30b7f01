"""RViz's displays, each as the entry of its configuration file. Topics are relative to RViz's namespace."""

import math
from typing import Any, Dict, Sequence

from .camera import Extent

Entry = Dict[str, Any]

LINES, SCAN, ROBOT = "120; 130; 145", "255; 85; 70", "90; 200; 250"  # red, green, blue
WAITING_MARKERS = 10000  # messages: at the start a world's markers wait for their transforms, and RViz drops the rest


def grid(extent: Extent) -> Entry:
    """Squares of 1 m on the floor, a metre wider than the extent, with lines at whole metres."""
    span = max(high - low for low, high in zip(extent.low, extent.high))
    x, y = (round((low + high) / 2.0) for low, high in zip(extent.low, extent.high))
    return {
        "Class": "rviz/Grid",
        "Name": "Grid",
        "Enabled": True,
        "Reference Frame": "<Fixed Frame>",
        "Plane": "XY",
        "Plane Cell Count": 2 * math.ceil(span / 2.0 + 1.0),
        "Cell Size": 1,
        "Offset": {"X": x, "Y": y, "Z": 0},
        "Line Style": {"Value": "Lines", "Line Width": 0.03},
        "Color": LINES,
        "Alpha": 0.4,
    }


def grid_map() -> Entry:
    """The occupancy grid on /map, dimmed so that white text is readable on it."""
    return {
        "Class": "rviz/Map",
        "Name": "Map",
        "Enabled": True,
        "Topic": "/map",
        "Color Scheme": "map",
        "Alpha": 0.35,
        "Draw Behind": True,
    }


def markers(name: str, topic: str, waiting: int) -> Entry:
    """Markers, of which this many messages may wait for their transforms."""
    return {
        "Class": "rviz/MarkerArray",
        "Name": name,
        "Enabled": True,
        "Marker Topic": topic,
        "Queue Size": waiting,
    }


def robot_model(description: str = "robot_description") -> Entry:
    """The robot's model, from a parameter."""
    return {
        "Class": "rviz/RobotModel",
        "Name": "Robot",
        "Enabled": True,
        "Robot Description": description,
        "TF Prefix": "",
        "Visual Enabled": True,
        "Collision Enabled": False,
        "Alpha": 1,
    }


def scan(topic: str = "scan") -> Entry:
    """The laser scan as red dots."""
    return {
        "Class": "rviz/LaserScan",
        "Name": "Scan",
        "Enabled": True,
        "Topic": topic,
        "Queue Size": 10,
        "Style": "Spheres",
        "Size (m)": 0.035,
        "Alpha": 1,
        "Decay Time": 0,
        "Color Transformer": "FlatColor",
        "Color": SCAN,
        "Position Transformer": "XYZ",
        "Selectable": False,
    }


def _odometry(name: str, topic: str, keep: int, tolerances: Sequence[float], arrow: Sequence[float]) -> Entry:
    """Odometry as arrows; arrow: length and radius of its shaft, then of its head [m]."""
    names = ("Shaft Length", "Shaft Radius", "Head Length", "Head Radius")
    return {
        "Class": "rviz/Odometry",
        "Name": name,
        "Enabled": True,
        "Topic": topic,
        "Queue Size": 10,
        "Keep": keep,
        "Position Tolerance": tolerances[0],
        "Angle Tolerance": tolerances[1],
        "Shape": {"Value": "Arrow", "Color": ROBOT, "Alpha": 0.8, **dict(zip(names, arrow))},
        "Covariance": {"Value": False},
    }


def trail() -> Entry:
    """Where odometry was, as small arrows every 5 cm."""
    return _odometry("Trail", "odom", 300, (0.05, 0.2), (0.04, 0.008, 0.025, 0.018))


def heading(topic: str) -> Entry:
    """Where odometry is, as one arrow."""
    return _odometry("Odometry", topic, 1, (0, 0), (0.3, 0.012, 0.06, 0.03))


def axes(frame: str) -> Entry:
    """The axes of one frame: x red, y green, z blue."""
    return {
        "Class": "rviz/Axes",
        "Name": f"Frame {frame}",
        "Enabled": True,
        "Reference Frame": frame,
        "Length": 0.3,
        "Radius": 0.012,
    }


def frames() -> Entry:
    """All TF frames with their names, not ticked: they would hide the robot."""
    return {
        "Class": "rviz/TF",
        "Name": "All frames",
        "Enabled": False,
        "Frame Timeout": 15,
        "Marker Scale": 0.6,
        "Show Axes": True,
        "Show Names": True,
        "Show Arrows": False,
        "Update Interval": 0,
    }


def image(topic: str) -> Entry:
    """A camera's image, in a panel of the display's name."""
    return {
        "Class": "rviz/Image",
        "Name": "Image",
        "Enabled": True,
        "Image Topic": topic,
        "Transport Hint": "raw",
        "Queue Size": 2,
        "Normalize Range": True,
    }
