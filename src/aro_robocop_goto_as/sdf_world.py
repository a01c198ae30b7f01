"""SDF elements -> World: of what a file describes only the collisions are kept, all that a robot can touch."""

import os
from dataclasses import dataclass, replace
from typing import Dict, List, Mapping, Optional, Set, Tuple

from . import resources, sdf
from .errors import WorldError
from .geometry import Pose2D, Pose3D, compose3, wrap_angle
from .motion import Motion
from .sdf_motion import check_can_move, is_motion, motion_of
from .sdf_shapes import Shapes
from .sdf_state import state_poses
from .shapes import Obstacle, Plane, World

SPAWN_FRAME = "robot_spawn"
DEEPEST = 20  # models within each other

# What SDF defines but a robot among fixed obstacles doesn't feel. What is neither here nor read is refused.
_SKIPPED: Dict[str, str] = {
    "world": "actor atmosphere audio gravity gui joint light magnetic_field physics plugin road scene sensor"
    " spherical_coordinates wind",
    "include": "plugin",
    "model": "allow_auto_disable enable_wind frame gripper joint plugin self_collide",
    "link": "audio_sink audio_source battery enable_wind frame gravity inertial kinematic light must_be_base_link"
    " projector self_collide sensor velocity_decay visual",
    "collision": "frame laser_retro max_contacts surface",
}
_GROUND_PLANE, _SUN = "model://ground_plane", "model://sun"
# Skipped as well, but worth telling: somebody put them there because they do something.
_TOLD = {
    "world": ("actor", "frame", "joint", "light", "plugin", "road", "sensor"),
    "include": ("plugin",),
    "model": ("frame", "joint", "plugin"),
    "link": ("frame", "light", "sensor"),
}


def read_world(path: str) -> World:
    """The world that an SDF file (1.4 to 1.7) describes: one <world>, or one <model> alone, such as a model.sdf.

    Raises WorldError that names file, line, element, what is wrong with it, and what is supported.
    """
    root = sdf.read_root(path, ("world", "model"))
    reading = _Reading(path)
    if root.tag == "model":
        reading.model(root, _Place(), None)
        return reading.world(sdf.name_of(root), Pose2D())
    sdf.check_children(root, ("frame", "include", "model", "state"), _SKIPPED["world"].split())
    reading.tell_skipped(root)
    reading.state = state_poses(root)
    reading.children(root, _Place())
    reading.tell_unused_state(root)
    return reading.world(sdf.name_of(root), _spawn(root))


def read_model(root: sdf.Element, name: str, pose: Pose3D) -> World:
    """A world of nothing but the <model> within an <sdf>, at another pose and, unless it is empty, by another name."""
    reading = _Reading(sdf.file_of(root))
    own_name = reading.model(sdf.root_of(root, ("model",)), _Place(), _Instead(name or None, pose, None))
    return reading.world(own_name, Pose2D())


def _is_spawn(element: sdf.Element) -> bool:
    """Whether an element of a <world> is our <frame>, where the robot starts."""
    return bool(element.tag == "frame" and element.get("name") == SPAWN_FRAME)


def _spawn(world: sdf.Element) -> Pose2D:
    frames = [frame for frame in world.iterchildren("frame") if _is_spawn(frame)]
    if not frames:
        return Pose2D()
    sdf.check_unique(frames)
    if frames[0].get("attached_to", "world") not in ("", "world"):
        raise sdf.error(frames[0], f"<frame name='{SPAWN_FRAME}'> is attached to a model; supported: to the world")
    x, y, z, roll, pitch, yaw = sdf.pose_numbers(frames[0])
    if (z, roll, pitch) != (0.0, 0.0, 0.0):
        raise sdf.error(frames[0], f"'{SPAWN_FRAME}' leaves the ground; supported: <pose>x y 0 0 0 yaw</pose>")
    return Pose2D(x, y, wrap_angle(yaw))


@dataclass(frozen=True)
class _Place:
    """Where an element stands: world_from_parent, the names of the models around it, what they do to it.

    static: whether one of them is, or has been told not to be
    motion: what moves them by script
    """

    pose: Pose3D = Pose3D()
    names: Tuple[str, ...] = ()
    static: bool = False
    motion: Optional[Motion] = None


@dataclass(frozen=True)
class _Instead:
    """What an <include> says of a model in place of the model's own file; None = nothing."""

    name: Optional[str]
    pose: Optional[Pose3D]
    static: Optional[bool]


class _Reading:
    """What has been read so far of one world and of the files that it includes."""

    def __init__(self, path: str) -> None:
        self.path = path
        self.obstacles: List[Obstacle] = []
        self.models: Dict[str, Pose3D] = {}
        self.told: List[str] = []
        self.state: Mapping[str, Tuple[Pose3D, sdf.Element]] = {}
        self.state_used: Set[str] = set()
        self.shapes = Shapes()
        self.open_files = [os.path.realpath(path)]  # the world's own, one that it includes, one that this includes

    def world(self, name: str, spawn: Pose2D) -> World:
        """All of it."""
        return World(name, tuple(self.obstacles), spawn, tuple(dict.fromkeys(self.told)), self.path, self.models)

    def tell(self, what: str, element: sdf.Element) -> None:
        """Note something that is left out; the line, and the file where it isn't the world's own."""
        file = sdf.file_of(element)
        line = f"line {element.sourceline}" if file == self.path else f"{file}:{element.sourceline}"
        self.told.append(f"{what} ({line})")

    def tell_skipped(self, element: sdf.Element) -> None:
        """Note which of an element's children do something that is left out here."""
        for child in element.iterchildren(*_TOLD[element.tag]):
            if (is_motion(child) and element.tag == "model") or (_is_spawn(child) and element.tag == "world"):
                continue
            self.tell(f"{child.tag} '{child.get('name', '')}'", child)

    def children(self, parent: sdf.Element, place: _Place) -> None:
        """The models and includes of a <world> or a <model>, whose names must differ."""
        if len(place.names) >= DEEPEST:
            raise sdf.error(parent, f"more than {DEEPEST} models within each other; supported: {DEEPEST}")
        taken: Set[str] = set()
        for element in parent.iterchildren("include", "model"):
            name = self.include(element, place) if element.tag == "include" else self.model(element, place, None)
            sdf.claim(name, element, taken)

    def include(self, include: sdf.Element, place: _Place) -> str:
        """A model of another file; returns its name."""
        sdf.check_children(include, ("name", "pose", "static", "uri"), _SKIPPED["include"].split())
        self.tell_skipped(include)
        uri = sdf.text_of(sdf.need(include, "uri")).rstrip("/")
        name = sdf.only(include, "name")
        pose = sdf.only(include, "pose")
        instead = _Instead(
            None if name is None else sdf.text_of(name),
            None if pose is None else sdf.pose_of(include),
            sdf.boolean(include, "static", False) if sdf.only(include, "static") is not None else None,
        )
        if uri == _SUN:
            self.tell("include 'sun'", include)
            return instead.name or "sun"
        if uri == _GROUND_PLANE:
            return self.ground_plane(instead, place)
        path = resources.find_model(uri, include)
        if os.path.realpath(path) in self.open_files:
            raise sdf.error(include, f"'{uri}' is {path} again, within itself; expected another model")
        self.open_files.append(os.path.realpath(path))
        try:
            return self.model(sdf.read_root(path, ("model",)), place, instead)
        except WorldError as exc:
            raise WorldError(f"{exc}; included by {sdf.file_of(include)}:{include.sourceline}") from exc
        finally:
            self.open_files.pop()

    def ground_plane(self, instead: _Instead, place: _Place) -> str:
        """Gazebo's own model of this name, which a world may include without having it."""
        name = instead.name or "ground_plane"
        pose = compose3(place.pose, instead.pose or Pose3D())
        names = "/".join((*place.names, name))
        self.obstacles.append(Obstacle(f"{names}/link/collision", pose, Plane((0.0, 0.0, 1.0))))
        if not place.names:
            self.models[name] = pose
        return name

    def model(self, model: sdf.Element, place: _Place, instead: Optional[_Instead]) -> str:
        """A model with all that is in it; returns its name."""
        sdf.check_children(model, ("include", "link", "model", "pose", "static"), _SKIPPED["model"].split())
        self.tell_skipped(model)
        instead = instead or _Instead(None, None, None)
        name = instead.name or sdf.name_of(model)
        inside = self.inside(model, name, place, instead)
        if not place.names:
            self.models[name] = inside.pose
        sdf.check_unique(model.iterchildren("link"))
        for link in model.iterchildren("link"):
            self.link(link, inside)
        self.children(model, inside)
        return name

    def inside(self, model: sdf.Element, name: str, place: _Place, instead: _Instead) -> _Place:
        """The place that a model makes for what is in it. One that could move is told, once, to stand still."""
        static = sdf.boolean(model, "static", False) if instead.static is None else instead.static
        own = sdf.pose_of(model) if instead.pose is None else instead.pose
        names = (*place.names, name)
        pose = self.saved("/".join(names), compose3(place.pose, own))
        motion = motion_of(model, pose) or place.motion
        if not (static or place.static or motion):
            self.tell(f"motion of model '{name}', which is not static", model)
        return _Place(pose, names, static=True, motion=motion)

    def saved(self, name: str, pose: Pose3D) -> Pose3D:
        """The pose that the world's <state> has for a model or link; where it has none, the one given."""
        if name not in self.state:
            return pose
        self.state_used.add(name)
        return self.state[name][0]

    def tell_unused_state(self, world: sdf.Element) -> None:
        """Note what <state> has poses of that is not in the world."""
        for name, (_, element) in self.state.items():
            if name not in self.state_used:
                self.tell(f"state of '{name}', which is not in <world name='{sdf.name_of(world)}'>", element)

    def link(self, link: sdf.Element, place: _Place) -> None:
        """A link's collisions."""
        sdf.check_children(link, ("collision", "pose"), _SKIPPED["link"].split())
        self.tell_skipped(link)
        sdf.check_unique(link.iterchildren("collision"))
        names = (*place.names, sdf.name_of(link))
        inside = replace(place, pose=self.saved("/".join(names), compose3(place.pose, sdf.pose_of(link))), names=names)
        for collision in link.iterchildren("collision"):
            self.collision(collision, inside)

    def collision(self, collision: sdf.Element, place: _Place) -> None:
        """One collision, unless its geometry is empty."""
        sdf.check_children(collision, ("geometry", "pose"), _SKIPPED["collision"].split())
        name = "/".join((*place.names, sdf.name_of(collision)))
        geometry = self.shapes.read(sdf.need(collision, "geometry"))
        if geometry is None:
            return
        pose = compose3(place.pose, sdf.pose_of(collision))
        if place.motion is not None:
            check_can_move(collision, geometry, pose)
        self.obstacles.append(Obstacle(name, pose, geometry, place.motion))
