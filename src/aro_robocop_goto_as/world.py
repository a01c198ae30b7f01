"""World file -> World.

Of an SDF world only what the robot can touch is kept: the collisions. sdf.py checks the file's elements and values.
"""

import math
import os
from dataclasses import dataclass
from typing import Callable, Dict, List, Tuple, Union

from aro_robocop_goto_as import sdf
from aro_robocop_goto_as.errors import WorldError
from aro_robocop_goto_as.geometry import Pose2D, Pose3D, Vector3, compose3, wrap_angle

SPAWN_FRAME = "robot_spawn"


@dataclass(frozen=True)
class Box:
    """A cuboid about the obstacle's origin; size: lengths [m] along the obstacle's x, y, z."""

    size: Vector3


@dataclass(frozen=True)
class Cylinder:
    """A cylinder about the obstacle's origin, its axis along the obstacle's z; radius, length [m]."""

    radius: float
    length: float


@dataclass(frozen=True)
class Sphere:
    """A ball about the obstacle's origin; radius [m]."""

    radius: float


@dataclass(frozen=True)
class Plane:
    """An infinite plane through the obstacle's origin; normal: unit vector in the obstacle's frame."""

    normal: Vector3


Geometry = Union[Box, Cylinder, Sphere, Plane]


@dataclass(frozen=True)
class Obstacle:
    """Something that stands still for ever.

    name: `model/link/collision`, unique in its world
    pose: world_from_obstacle, the centre of the geometry (for a Plane: a point on it) in the world frame [m]
    """

    name: str
    pose: Pose3D
    geometry: Geometry


@dataclass(frozen=True)
class World:
    """What a world file says about the robot's surroundings.

    obstacles: in the file's order, the ground among them
    spawn: world_from_base_footprint at the start [m, rad]
    ignored: what was left out and could be missed, once each, such as "light 'sun' (line 4)"
    path: the file, as it was given to load_world
    """

    name: str
    obstacles: Tuple[Obstacle, ...]
    spawn: Pose2D
    ignored: Tuple[str, ...]
    path: str


def find_world(name_or_path: str, directory: str) -> str:
    """The path of a world: DIRECTORY/NAME.sdf for a bare name, else the path itself.

    A bare name has no slash and ends in neither .sdf nor .world. WorldError if there is no such file.
    """
    bare = os.path.basename(name_or_path) == name_or_path and not name_or_path.endswith((".sdf", ".world"))
    path = os.path.join(directory, name_or_path + ".sdf") if bare else name_or_path
    if os.path.isfile(path):
        return path
    entries = os.listdir(directory) if os.path.isdir(directory) else []
    known = sorted(entry[: -len(".sdf")] for entry in entries if entry.endswith(".sdf"))
    raise WorldError(
        f"there is no world '{name_or_path}' (no file {os.path.abspath(path)}); "
        f"worlds in {directory}: {', '.join(known) or 'none'}"
    )


def load_world(path: str) -> World:
    """The world that an SDF file (1.4 to 1.7, one <world>, static models) describes.

    A misspelt element is an error, not a missing wall. Raises WorldError that names file, line, element, what is wrong
    with it, and what is supported.
    """
    world = sdf.read_world(path)
    sdf.check_children(world, read=("frame", "include", "model"), skipped=_SKIPPED["world"].split())
    sdf.check_unique(world.iterchildren("include", "model"))
    obstacles: List[Obstacle] = []
    for element in world.iterchildren("include", "model"):
        obstacles.extend(_READERS[element.tag](element))
    return World(sdf.name_of(world), tuple(obstacles), _spawn(world), _ignored(world), path)


# What SDF defines but a robot among static obstacles doesn't feel. Not here, so refused: <state> and <population>,
# which move or add models, as well as models and includes within models.
_SKIPPED: Dict[str, str] = {
    "world": "actor atmosphere audio gravity gui light magnetic_field physics plugin road scene sensor"
    " spherical_coordinates wind",
    "include": "name",
    "model": "allow_auto_disable enable_wind frame gripper joint plugin self_collide",
    "link": "audio_sink audio_source battery enable_wind frame gravity inertial kinematic light must_be_base_link"
    " projector self_collide sensor velocity_decay visual",
    "collision": "frame laser_retro max_contacts surface",
}
_GROUND_PLANE, _SUN = "model://ground_plane", "model://sun"
# Skipped as well, but worth telling (XPath from <world>): somebody put them there because they do something.
_TOLD = f"""actor | light | plugin | road | sensor | include[normalize-space(uri)='{_SUN}']
    | model/plugin | model/link/light | model/link/sensor"""


def _ignored(world: sdf.Element) -> Tuple[str, ...]:
    told = (f"{item.tag} '{sdf.name_of(item)}' (line {item.sourceline})" for item in world.xpath(_TOLD))
    return tuple(dict.fromkeys(told))


def _spawn(world: sdf.Element) -> Pose2D:
    frames = [frame for frame in world.iterchildren("frame") if frame.get("name") == SPAWN_FRAME]
    if not frames:
        return Pose2D()
    sdf.check_unique(frames)
    if frames[0].get("attached_to", "world") not in ("", "world"):
        raise sdf.error(frames[0], f"<frame name='{SPAWN_FRAME}'> is attached to a model; supported: to the world")
    x, y, z, roll, pitch, yaw = sdf.pose_numbers(frames[0])
    if (z, roll, pitch) != (0.0, 0.0, 0.0):
        raise sdf.error(frames[0], f"'{SPAWN_FRAME}' leaves the ground; supported: <pose>x y 0 0 0 yaw</pose>")
    return Pose2D(x, y, wrap_angle(yaw))


def _include(include: sdf.Element) -> List[Obstacle]:
    sdf.check_children(include, read=("pose", "static", "uri"), skipped=_SKIPPED["include"].split())
    uri = sdf.text_of(sdf.need(include, "uri"))
    if uri not in (_GROUND_PLANE, _SUN):
        raise sdf.error(include, f"<include> of '{uri}' is not supported; supported: {_GROUND_PLANE}, {_SUN}")
    _check_static(include, default=True)
    pose = sdf.pose_of(include)
    if uri == _SUN:
        return []
    return [Obstacle(f"{sdf.name_of(include)}/link/collision", pose, Plane((0.0, 0.0, 1.0)))]


def _model(model: sdf.Element) -> List[Obstacle]:
    sdf.check_children(model, read=("link", "pose", "static"), skipped=_SKIPPED["model"].split())
    _check_static(model, default=False)
    sdf.check_unique(model.iterchildren("link"))
    world_from_model = sdf.pose_of(model)
    obstacles: List[Obstacle] = []
    for link in model.iterchildren("link"):
        sdf.check_children(link, read=("collision", "pose"), skipped=_SKIPPED["link"].split())
        sdf.check_unique(link.iterchildren("collision"))
        world_from_link = compose3(world_from_model, sdf.pose_of(link))
        names = (sdf.name_of(model), sdf.name_of(link))
        obstacles.extend(_collision(item, names, world_from_link) for item in link.iterchildren("collision"))
    return obstacles


_READERS: Dict[str, Callable[[sdf.Element], List[Obstacle]]] = {"include": _include, "model": _model}


def _check_static(element: sdf.Element, default: bool) -> None:
    if not sdf.boolean(element, "static", default):
        raise sdf.error(element, f"this <{element.tag}> is not static; supported: static models only")


def _collision(collision: sdf.Element, names: Tuple[str, str], world_from_link: Pose3D) -> Obstacle:
    sdf.check_children(collision, read=("geometry", "pose"), skipped=_SKIPPED["collision"].split())
    name = "/".join((*names, sdf.name_of(collision)))
    pose = compose3(world_from_link, sdf.pose_of(collision))
    return Obstacle(name, pose, _geometry(sdf.need(collision, "geometry")))


def _geometry(geometry: sdf.Element) -> Geometry:
    sdf.check_children(geometry, read=_SHAPES)
    shapes = [child for child in geometry if child.tag in _SHAPES]
    if len(shapes) != 1:
        raise sdf.error(geometry, f"<geometry> holds {len(shapes)} shapes; supported: one of {', '.join(_SHAPES)}")
    return _SHAPES[shapes[0].tag](shapes[0])


def _box(box: sdf.Element) -> Box:
    x, y, z = sdf.sizes(sdf.need(box, "size"), 3)
    return Box((x, y, z))


def _cylinder(cylinder: sdf.Element) -> Cylinder:
    (radius,), (length,) = (sdf.sizes(sdf.need(cylinder, tag), 1) for tag in ("radius", "length"))
    return Cylinder(radius, length)


def _plane(plane: sdf.Element) -> Plane:
    # SDF's <size> is that of the visual: its plane collides everywhere.
    normal = sdf.only(plane, "normal")
    x, y, z = (0.0, 0.0, 1.0) if normal is None else sdf.numbers(normal, 3)
    length = math.hypot(x, y, z)
    if not 0.0 < length < math.inf:
        raise sdf.error(plane, f"<normal> is '{x} {y} {z}', expected a direction")
    return Plane((x / length, y / length, z / length))


def _sphere(sphere: sdf.Element) -> Sphere:
    (radius,) = sdf.sizes(sdf.need(sphere, "radius"), 1)
    return Sphere(radius)


_SHAPES: Dict[str, Callable[[sdf.Element], Geometry]] = {
    "box": _box,
    "cylinder": _cylinder,
    "plane": _plane,
    "sphere": _sphere,
}
