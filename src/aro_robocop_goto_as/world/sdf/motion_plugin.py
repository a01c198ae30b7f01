"""Read a model's <plugin filename="robocop_motion">, this package's own, as scripted motion."""

import math
from typing import List, Optional

from ...geometry import Pose3D
from ...reading import Element
from ...shapes import Cylinder, Geometry, Sphere
from ..scripted_motion import Motion, Waypoint
from . import xml

PLUGIN = "robocop_motion"
CLOSED = 1e-9  # [m] the last waypoint has to be this near to the start


def is_motion(element: Element) -> bool:
    """Return whether an element is a <plugin> of this package."""
    return bool(element.tag == "plugin" and element.get("filename") == PLUGIN)


def motion_of(model: Element, world_from_model: Pose3D) -> Optional[Motion]:
    """The motion that a model's plugin describes, or None if it has no such plugin; WorldError if it is impossible."""
    plugins = [plugin for plugin in model.iterchildren("plugin") if is_motion(plugin)]
    if not plugins:
        return None
    plugin = plugins[0]
    if len(plugins) > 1:
        raise xml.error(plugins[1], f"a second <plugin filename='{PLUGIN}'>; supported: one")
    for child in xml.unknown_children(plugin, ("turn", "waypoint")):
        raise xml.error(child, f"{xml.title_of(child)} in <plugin> is not supported; supported: turn, waypoint")
    if not world_from_model.is_upright():
        raise xml.error(plugin, "the model that it moves is tilted; supported: upright models")
    turn = xml.optional_child(plugin, "turn")
    turn_rate = 0.0 if turn is None else xml.numbers(turn, 1)[0]
    return Motion(world_from_model.on_plane(), turn_rate, tuple(_waypoints(plugin)))


def _waypoints(plugin: Element) -> List[Waypoint]:
    waypoints: List[Waypoint] = []
    for element in plugin.iterchildren("waypoint"):
        time, x, y = xml.numbers(element, 3)
        if time <= (waypoints[-1][0] if waypoints else 0.0):
            raise xml.error(element, f"<waypoint> at {time:g} s, expected a time later than that of the previous one")
        waypoints.append((time, x, y))
    if waypoints and math.hypot(*waypoints[-1][1:]) > CLOSED:
        _, x, y = waypoints[-1]
        raise xml.error(plugin, f"the last <waypoint> is at '{x:g} {y:g}', expected 0 0, where the cycle starts again")
    return waypoints


def require_movable_shape(collision: Element, geometry: Geometry, pose: Pose3D) -> None:
    """WorldError unless the scanners and both engines support motion of a shape."""
    if not (isinstance(geometry, Sphere) or (isinstance(geometry, Cylinder) and pose.is_upright())):
        raise xml.error(collision, f"a model moved by {PLUGIN} has this shape; supported: upright cylinders, spheres")
