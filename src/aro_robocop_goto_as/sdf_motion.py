"""<plugin filename="robocop_motion"> of a model -> Motion."""

import math
from typing import List, Optional

from . import sdf
from .geometry import Pose3D
from .motion import Motion, Waypoint
from .shapes import Cylinder, Geometry, Sphere

PLUGIN = "robocop_motion"
LEVEL = 1e-9


def is_motion(element: sdf.Element) -> bool:
    """Whether a <plugin> is ours."""
    return bool(element.tag == "plugin" and element.get("filename") == PLUGIN)


def motion_of(model: sdf.Element, world_from_model: Pose3D) -> Optional[Motion]:
    """The motion that a model's plugin of ours describes; None without one. WorldError where it can't be."""
    plugins = [plugin for plugin in model.iterchildren("plugin") if is_motion(plugin)]
    if not plugins:
        return None
    plugin = plugins[0]
    if len(plugins) > 1:
        raise sdf.error(plugins[1], f"a second <plugin filename='{PLUGIN}'>; supported: one")
    sdf.check_children(plugin, read=("turn", "waypoint"))
    if abs(world_from_model.orientation[0]) + abs(world_from_model.orientation[1]) > LEVEL:
        raise sdf.error(plugin, "the model that it moves leans; supported: level models, which turn about the vertical")
    turn = sdf.only(plugin, "turn")
    speed = 0.0 if turn is None else sdf.numbers(turn, 1)[0]
    return Motion(world_from_model.on_plane(), speed, tuple(_waypoints(plugin)))


def _waypoints(plugin: sdf.Element) -> List[Waypoint]:
    found: List[Waypoint] = []
    for element in plugin.iterchildren("waypoint"):
        time, x, y = sdf.numbers(element, 3)
        if time <= (found[-1][0] if found else 0.0):
            raise sdf.error(element, f"<waypoint> at {time:g} s, expected a later time than that of the one before")
        found.append((time, x, y))
    if found and math.hypot(found[-1][1], found[-1][2]) > LEVEL:
        raise sdf.error(plugin, f"the last <waypoint> is '{found[-1][1]:g} {found[-1][2]:g}', expected 0 0: back home")
    return found


def check_can_move(collision: sdf.Element, geometry: Geometry, pose: Pose3D) -> None:
    """WorldError unless scans and both drives can take a shape along."""
    upright = abs(pose.orientation[0]) + abs(pose.orientation[1]) <= LEVEL
    if not (isinstance(geometry, Sphere) or (isinstance(geometry, Cylinder) and upright)):
        raise sdf.error(collision, f"a model moved by {PLUGIN} has this shape; supported: upright cylinders, spheres")
