"""RViz markers of the world's obstacles, in their true place, size and shape, and of named robots."""

from typing import List, Sequence, Tuple

from geometry_msgs.msg import Point, Vector3
from std_msgs.msg import ColorRGBA
from visualization_msgs.msg import Marker

from ...shapes import Box, Cylinder, Mesh, Plane, Sphere, Walls
from ...world.ground import is_in_ground
from ...world.model import Obstacle, World
from ..convert import to_pose_msg
from ..markers import marker, text

COLOR = ColorRGBA(0.62, 0.70, 0.80, 0.55)  # translucent: walls must not hide the scan and the robot behind them
BODIES = {  # of the robots in turn; pink and grey are the goal's and the walls'
    "blue": (0.35, 0.78, 0.98),
    "yellow": (0.98, 0.80, 0.25),
    "green": (0.60, 0.86, 0.35),
    "violet": (0.78, 0.60, 0.98),
    "orange": (0.98, 0.62, 0.40),
    "turquoise": (0.35, 0.90, 0.78),
}
RED = (0.92, 0.36, 0.30)  # the scan's: only of a robot called red
NOSE = ColorRGBA(0.10, 0.11, 0.13, 1.0)
CLEAR = Marker(action=Marker.DELETEALL)  # deletes earlier markers: a changed world may have fewer obstacles
BODY_HEIGHT, NOSE_HEIGHT, NAME_HEIGHT = 0.15, 0.17, 0.6  # [m] above the floor


def _obstacle_marker(number: int, frame: str, obstacle: Obstacle, time: float) -> Marker:
    shape, made = obstacle.geometry, marker("world", Marker.CUBE, frame, COLOR, number)
    made.pose = to_pose_msg(obstacle.at(time))
    if isinstance(shape, Box):
        made.scale = Vector3(*shape.size)
    elif isinstance(shape, Cylinder):
        made.type = Marker.CYLINDER
        made.scale = Vector3(2.0 * shape.radius, 2.0 * shape.radius, shape.length)
    elif isinstance(shape, Sphere):
        made.type, made.scale = Marker.SPHERE, Vector3(*(2.0 * shape.radius,) * 3)
    elif isinstance(shape, Mesh):
        made.type, made.scale = Marker.TRIANGLE_LIST, Vector3(1.0, 1.0, 1.0)
        made.points = [Point(*corner) for corner in shape.corners.reshape(-1, 3).tolist()]
    else:
        raise TypeError(f"no marker for {shape!r}")
    return made


def world_markers(world: World, frame: str, time: float, moving: bool = False) -> List[Marker]:
    """One marker per obstacle, or per moving obstacle, where it is at a time [s], in the world's `frame`.

    Ground, planes and the walls of a map are left out: RViz's grid shows the ground and its Map display the map.
    """
    solid = [o for o in world.obstacles if not (isinstance(o.geometry, (Plane, Walls)) or is_in_ground(o))]
    return [
        _obstacle_marker(number, frame, obstacle, time)
        for number, obstacle in enumerate(solid)
        if obstacle.motion is not None or not moving
    ]


def body_color(name: str, number: int) -> ColorRGBA:
    """The colour that a robot is named after, else one by its number."""
    colors = list(BODIES.values())
    return ColorRGBA(*{"red": RED, **BODIES}.get(name, colors[number % len(colors)]), 1.0)


def robot_markers(robots: Sequence[Tuple[str, str, float]]) -> List[Marker]:
    """A coloured body, an arrow ahead and a name for each robot, given as its name, base frame and radius [m].

    RViz needs one RobotModel display per robot, so many robots are shown as markers instead.
    """
    found: List[Marker] = []
    for number, (name, frame, radius) in enumerate(robots):
        body = marker("robots", Marker.CYLINDER, frame, body_color(name, number), number)
        body.scale, body.pose.position.z = Vector3(2.0 * radius, 2.0 * radius, BODY_HEIGHT), BODY_HEIGHT / 2.0
        nose = marker("noses", Marker.ARROW, frame, NOSE, number)
        nose.scale, nose.pose.position.z = Vector3(1.3 * radius, 0.03, 0.03), NOSE_HEIGHT
        label = text("names", name, frame, number)
        label.pose.position.z = NAME_HEIGHT
        found += [body, nose, label]
    return found
