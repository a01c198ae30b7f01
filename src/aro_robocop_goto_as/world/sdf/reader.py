"""Read the worlds and models of SDF files; only their collisions are kept, as these are what robots can touch."""

import os
from dataclasses import dataclass, replace
from typing import Dict, List, Mapping, Optional, Set, Tuple

from ...errors import WorldError
from ...geometry import Pose2D, Pose3D, wrap_angle
from ..model import Obstacle, Plane, World
from ..scripted_motion import Motion
from . import frames, uris, xml
from .motion_plugin import is_motion, motion_of, require_movable_shape
from .shapes import Shapes
from .state import SavedPoses, state_poses

SPAWN_FRAME = "robot_spawn"
MAX_DEPTH = 20  # of models within models

# Elements of SDF that have no effect on a robot among fixed obstacles. Those neither listed here nor read are refused.
_SKIPPED: Mapping[str, List[str]] = {
    tag: names.split()
    for tag, names in {
        "world": "actor atmosphere audio gravity gui joint light magnetic_field physics plugin road scene sensor"
        " spherical_coordinates wind",
        "include": "plugin",
        "model": "allow_auto_disable enable_wind frame gripper joint plugin self_collide",
        "link": "audio_sink audio_source battery enable_wind frame gravity inertial kinematic light must_be_base_link"
        " particle_emitter projector self_collide sensor velocity_decay visual",
        "collision": "frame laser_retro max_contacts surface",
    }.items()
}
# Skipped elements that users may expect to have an effect, so they are listed in World.ignored.
_REPORTED: Mapping[str, Tuple[str, ...]] = {
    "world": ("actor", "joint", "light", "plugin", "road", "sensor"),
    "include": ("plugin",),
    "model": ("joint", "plugin"),
    "link": ("frame", "light", "sensor"),
}
_GROUND_PLANE, _SUN = "model://ground_plane", "model://sun"


def read_world(path: str) -> World:
    """The world in an SDF file (1.4 to 1.8) that contains one <world>, or one <model> such as a model.sdf.

    WorldError names the file, line and element, what is wrong with it, and what is supported.
    """
    root = xml.read_root(path, ("world", "model"))
    reader = _Reader(path)
    if root.tag == "model":
        reader.model(root, _Parent())
        return reader.world(xml.name_of(root))
    xml.require_known_children(root, ("frame", "include", "model", "state"), _SKIPPED["world"])
    reader.report_skipped(root)
    reader.state = state_poses(root)
    reader.children(root, _Parent())
    reader.report_unused_state(root)
    return reader.world(xml.name_of(root), _spawn(root))


def read_model(root: xml.Element, name: str, pose: Pose3D) -> World:
    """A world that contains only the <model> of an <sdf>, at another pose and under a name; empty: its own name."""
    reader = _Reader(xml.file_of(root))
    model_name = reader.model(xml.root_of(root, ("model",)), _Parent(), _Override(name or None, pose))
    return reader.world(model_name)


def _is_spawn(element: xml.Element) -> bool:
    """Whether a child of a <world> is this package's <frame> for the robot's starting pose."""
    return bool(element.tag == "frame" and element.get("name") == SPAWN_FRAME)


def _spawn(world: xml.Element) -> Optional[Pose2D]:
    spawns = [frame for frame in world.iterchildren("frame") if _is_spawn(frame)]
    if not spawns:
        return None
    xml.require_unique_names(spawns)
    if spawns[0].get("attached_to", "world") not in ("", "world"):
        raise xml.error(spawns[0], f"<frame name='{SPAWN_FRAME}'> is attached to a model; supported: to the world")
    x, y, z, roll, pitch, yaw = xml.pose_numbers(spawns[0])
    if (z, roll, pitch) != (0.0, 0.0, 0.0):
        raise xml.error(spawns[0], f"'{SPAWN_FRAME}' is not on the ground; supported: <pose>x y 0 0 0 yaw</pose>")
    return Pose2D(x, y, wrap_angle(yaw))


@dataclass(frozen=True)
class _Parent:
    """What an element inherits from the models and links around it.

    pose: world_from_parent
    names: of the models and links, the outermost first
    static: whether one of the models is static, or its motion has already been reported as ignored
    motion: the scripted motion of the innermost model that has one
    """

    pose: Pose3D = Pose3D()
    names: Tuple[str, ...] = ()
    static: bool = False
    motion: Optional[Motion] = None


@dataclass(frozen=True)
class _Override:
    """What an <include> or request overrides; None: keep the file's value."""

    name: Optional[str] = None
    pose: Optional[Pose3D] = None  # in the world
    static: Optional[bool] = None


class _Reader:
    """Collects the contents of one world and of the files that it includes."""

    def __init__(self, path: str) -> None:
        self.path = path
        self.obstacles: List[Obstacle] = []
        self.models: Dict[str, Pose3D] = {}
        self.ignored: List[str] = []
        self.state: SavedPoses = {}
        self.state_used: Set[str] = set()
        self.shapes = Shapes()
        self.open_files = [os.path.realpath(path)]  # the world's file and the chain of includes being read

    def world(self, name: str, spawn: Optional[Pose2D] = None) -> World:
        """The world with everything read so far."""
        return World(
            name,
            tuple(self.obstacles),
            spawn or Pose2D(),
            tuple(dict.fromkeys(self.ignored)),
            self.path,
            self.models,
            has_spawn=spawn is not None,
        )

    def report(self, what: str, element: xml.Element) -> None:
        """Add an element to the world's `ignored`, with its line, and its file if that is an included one."""
        file = xml.file_of(element)
        line = f"line {element.sourceline}" if file == self.path else f"{file}:{element.sourceline}"
        self.ignored.append(f"{what} ({line})")

    def report_skipped(self, element: xml.Element) -> None:
        """Report the children of an element that users may expect to have an effect."""
        for child in element.iterchildren(*_REPORTED[element.tag]):
            if is_motion(child) and element.tag == "model":
                continue
            self.report(f"{child.tag} '{child.get('name', '')}'", child)

    def children(self, element: xml.Element, parent: _Parent) -> None:
        """Read the models and includes in a <world> or a <model>; their names must differ."""
        if len(parent.names) >= MAX_DEPTH:
            raise xml.error(element, f"more than {MAX_DEPTH} models within each other; supported: {MAX_DEPTH}")
        used: Set[str] = set()
        for child in element.iterchildren("include", "model"):
            name = self.include(child, parent) if child.tag == "include" else self.model(child, parent)
            xml.claim_name(name, child, used)

    def include(self, include: xml.Element, parent: _Parent) -> str:
        """Read the model that an <include> refers to; returns its name."""
        xml.require_known_children(include, ("name", "pose", "static", "uri"), _SKIPPED["include"])
        self.report_skipped(include)
        if include.attrib:
            raise xml.error(include, f"<include {include.keys()[0]}='...'> is not supported; expected no attributes")
        uri = uris.normalised(xml.text_of(xml.required_child(include, "uri")))
        name = xml.optional_child(include, "name")
        pose = xml.optional_child(include, "pose")
        override = _Override(
            None if name is None else xml.text_of(name),
            None if pose is None else frames.placed(include, parent.pose),
            xml.boolean(include, "static"),
        )
        if uri == _SUN:
            self.report("include 'sun'", include)
            return override.name or "sun"
        if uri == _GROUND_PLANE:
            return self.ground_plane(override, parent)
        path = uris.find_model(uri, include)
        if os.path.realpath(path) in self.open_files:
            raise xml.error(include, f"'{uri}' is {path} again, within itself; expected another model")
        self.open_files.append(os.path.realpath(path))
        try:
            return self.model(xml.read_root(path, ("model",)), parent, override)
        except WorldError as exc:
            raise WorldError(f"{exc}; included by {xml.file_of(include)}:{include.sourceline}") from exc
        finally:
            self.open_files.pop()

    def ground_plane(self, override: _Override, parent: _Parent) -> str:
        """Add Gazebo's ground_plane, which may be included without having the model's files."""
        name = override.name or "ground_plane"
        pose = override.pose or parent.pose
        names = "/".join((*parent.names, name))
        self.obstacles.append(Obstacle(f"{names}/link/collision", pose, Plane((0.0, 0.0, 1.0))))
        if not parent.names:
            self.models[name] = pose
        return name

    def model(self, model: xml.Element, parent: _Parent, override: _Override = _Override()) -> str:
        """Read a model with its links and nested models; returns its name."""
        xml.require_known_children(model, ("include", "link", "model", "pose", "static"), _SKIPPED["model"])
        self.report_skipped(model)
        name = override.name or xml.name_of(model)
        as_parent = self.as_parent(model, name, parent, override)
        if not parent.names:
            self.models[name] = as_parent.pose
        xml.require_unique_names(model.iterchildren("link"))
        for link in model.iterchildren("link"):
            self.link(link, as_parent)
        self.children(model, as_parent)
        return name

    def as_parent(self, model: xml.Element, name: str, parent: _Parent, override: _Override) -> _Parent:
        """What a model passes on to its contents. A model that is not static is reported once, and stands still."""
        static = xml.boolean(model, "static") if override.static is None else override.static
        if model.get("placement_frame"):
            raise xml.error(
                model, "the attribute placement_frame is not supported; expected a model placed by its origin"
            )
        pose = frames.placed(model, parent.pose) if override.pose is None else override.pose
        names = (*parent.names, name)
        world_pose = self.saved_pose("/".join(names), pose)
        motion = motion_of(model, world_pose) or parent.motion
        if not (static or parent.static or motion):
            self.report(f"motion of model '{name}', which is not static", model)
        return _Parent(world_pose, names, static=True, motion=motion)

    def saved_pose(self, name: str, pose: Pose3D) -> Pose3D:
        """The pose of a model or link in the world's <state>, or the given one if the <state> has none."""
        if name not in self.state:
            return pose
        self.state_used.add(name)
        return self.state[name][0]

    def report_unused_state(self, world: xml.Element) -> None:
        """Report the poses in <state> of models and links that the world does not contain."""
        for name, (_, element) in self.state.items():
            if name not in self.state_used:
                self.report(f"state of '{name}', which is not in <world name='{xml.name_of(world)}'>", element)

    def link(self, link: xml.Element, parent: _Parent) -> None:
        """Read a link's collisions."""
        xml.require_known_children(link, ("collision", "pose"), _SKIPPED["link"])
        self.report_skipped(link)
        xml.require_unique_names(link.iterchildren("collision"))
        names = (*parent.names, xml.name_of(link))
        pose = self.saved_pose("/".join(names), frames.placed(link, parent.pose))
        for collision in link.iterchildren("collision"):
            self.collision(collision, replace(parent, pose=pose, names=names))

    def collision(self, collision: xml.Element, parent: _Parent) -> None:
        """Read one collision, unless its geometry is <empty>."""
        xml.require_known_children(collision, ("geometry", "pose"), _SKIPPED["collision"])
        name = "/".join((*parent.names, xml.name_of(collision)))
        geometry = self.shapes.read(xml.required_child(collision, "geometry"))
        if geometry is None:
            return
        pose = frames.placed(collision, parent.pose)
        if parent.motion is not None:
            require_movable_shape(collision, geometry, pose)
        self.obstacles.append(Obstacle(name, pose, geometry, parent.motion))
