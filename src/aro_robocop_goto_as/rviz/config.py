"""A scene -> the text of RViz's configuration file."""

from dataclasses import dataclass, field
from typing import Any, Dict, List, Sequence, Tuple

import yaml

from . import displays
from .camera import PITCH, YAW, Extent, Orbit, fitting
from .displays import Entry

DOCK_WIDTH, BARS_HEIGHT = 380, 92  # [pixel] of the window that the view does not have, in RViz 1.14
BACKGROUND = "38; 42; 50"  # red, green, blue
FIXED = "<Fixed Frame>"
WORLD_TOPIC, SERVER_TOPIC = "/robocop_sim/world", "aro_robocop_goto_as_node/markers"
WATCH = "/robocop_watch"  # namespace of what the grader publishes for RViz only
HEADER = "# Written by ./robocop for what it shows; rviz_config:=FILE opens a file of your own instead.\n"


@dataclass(frozen=True)
class Window:
    """Position and size of RViz's window on the screen [pixel]."""

    x: int = 40
    y: int = 40
    width: int = 1200
    height: int = 780

    @property
    def aspect(self) -> float:
        """Width / height of the 3D view, beside the panels."""
        return max(self.width - DOCK_WIDTH, 1) / max(self.height - BARS_HEIGHT, 1)


@dataclass(frozen=True)
class Scene:
    """What RViz is to show: the part of the world, and those displays that have something to show.

    A display of markers shows no error while nobody publishes them, so these may be included for later.
    """

    fixed_frame: str = "map"
    camera_frame: str = FIXED  # of the extent
    extent: Extent = field(default_factory=Extent)
    window: Window = field(default_factory=Window)
    grid_map: bool = False
    world: bool = True  # the simulator's markers: obstacles, and robots that have names
    model: bool = True  # the model of a robot without a name
    scan: bool = True
    trail: bool = True
    axes: Tuple[str, ...] = ("map", "odom")  # frames whose axes are shown
    server: bool = True  # the markers of the go-to server
    image: str = ""  # topic of a camera's images


def robocop(scene: Scene) -> str:
    """The configuration of the simulator or a real robot."""
    shown = [
        (True, displays.grid(scene.extent)),
        (scene.grid_map, displays.grid_map()),
        (scene.world, displays.markers("World", WORLD_TOPIC, displays.WAITING_MARKERS)),
        (scene.model, displays.robot_model()),
        (scene.scan, displays.scan()),
        (scene.trail, displays.trail()),
        *((True, displays.axes(frame)) for frame in scene.axes),
        (True, displays.frames()),
        (scene.server, displays.markers("Server", SERVER_TOPIC, 1)),
        (bool(scene.image), displays.image(scene.image)),
    ]
    tools: List[Entry] = [
        {
            "Class": "rviz/SetInitialPose",
            "Topic": "initialpose",
            "Theta std deviation": 0.26,
            "X std deviation": 0.5,
            "Y std deviation": 0.5,
        },
        {"Class": "rviz/SetGoal", "Topic": "move_base_simple/goal"},
    ]
    docks: Dict[str, Any] = {"Displays": {"collapsed": False}}
    if scene.image:
        docks["Image"] = {"collapsed": False}
    view = _view(fitting(scene.extent, scene.window.aspect), PITCH, YAW, scene.camera_frame)
    manager = _manager([entry for wanted, entry in shown if wanted], scene.fixed_frame, tools, view)
    return _text([_tree()], manager, {**docks, "Hide Left Dock": False, **_geometry(scene.window)})


def grading_watch(window: Window) -> str:
    """The configuration of `grade --watch`.

    The camera follows the robot, because odom starts at zero in every scenario. The Displays panel is hidden to enlarge
    the view; the menu Panels shows it.
    """
    shown = [
        displays.grid(Extent()),
        displays.robot_model(f"{WATCH}/robot_description"),
        displays.scan("/scan"),
        displays.heading("/odom"),
        displays.axes("odom"),
        displays.markers("Scenario", f"{WATCH}/scene", 10),
    ]
    view = _view(Orbit(3.8, 0.35, 0.0), 0.95, 3.14159, "base_footprint")
    manager = _manager(shown, "odom", [], view)
    return _text([], manager, {"Hide Left Dock": True, **_geometry(window)})


def _tree() -> Entry:
    return {
        "Class": "rviz/Displays",
        "Name": "Displays",
        "Property Tree Widget": {"Expanded": ["/Global Options1"], "Splitter Ratio": 0.6},
        "Help Height": 0,
        "Tree Height": 600,
    }


def _view(orbit: Orbit, pitch: float, yaw: float, frame: str) -> Entry:
    return {
        "Class": "rviz/Orbit",
        "Name": "Current View",
        "Distance": round(orbit.distance, 3),
        "Focal Point": {"X": round(orbit.x, 3), "Y": round(orbit.y, 3), "Z": 0},
        "Pitch": pitch,
        "Yaw": round(yaw, 5),
        "Near Clip Distance": 0.01,
        "Target Frame": frame,
    }


def _manager(shown: Sequence[Entry], fixed_frame: str, tools: Sequence[Entry], view: Entry) -> Entry:
    always = [{"Class": "rviz/Interact", "Hide Inactive Objects": True}, {"Class": "rviz/MoveCamera"}]
    return {
        "Class": "",
        "Displays": list(shown),
        "Enabled": True,
        "Global Options": {
            "Background Color": BACKGROUND,
            "Default Light": True,
            "Fixed Frame": fixed_frame,
            "Frame Rate": 20,
        },
        "Tools": [*always, *tools],
        "Value": True,
        "Views": {"Current": view, "Saved": None},
    }


def _geometry(window: Window) -> Entry:
    return {
        "Hide Right Dock": True,
        "X": window.x,
        "Y": window.y,
        "Width": window.width,
        "Height": window.height,
    }


def _text(panels: Sequence[Entry], manager: Entry, geometry: Entry) -> str:
    document = {
        "Panels": list(panels),
        "Preferences": {"PromptSaveOnExit": False},
        "Visualization Manager": manager,
        "Window Geometry": geometry,
    }
    return HEADER + str(yaml.safe_dump(document, sort_keys=False))
