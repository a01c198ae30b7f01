"""Read the worlds and models of SDF files; only their collisions are kept, as these are what robots can touch."""

import os
import re
from dataclasses import dataclass, replace
from typing import Dict, List, Mapping, Optional, Set, Tuple

import numpy as np

from ...errors import WorldError
from ...geometry import Pose2D, Pose3D
from ...reading import Element, file_of, parse_xml
from ..ground import MAX_TOP
from ..model import Obstacle, World
from ..scripted_motion import Motion
from . import frames, uris, xml
from .motion_plugin import is_motion, motion_of, require_movable_shape
from .saved_robot import is_robot, is_robot_name
from .shapes import read_shape
from .state import SavedPoses, state_poses

SPAWN_FRAME = "robot_spawn"
MOTION = "motion of models that are not static"
MAX_DEPTH = 20  # of models within models
MAX_MODELS = 5000  # as a file that includes another one twice, which includes a third one twice, ...

# Children of SDF's elements that have no effect on a robot among fixed obstacles. A <plugin> may have one, so it is in
# World.ignored. A child that is neither here nor read is left out, and in World.approximated.
_UNUSED: Mapping[str, str] = {
    "world": "actor atmosphere audio gravity gui joint light magnetic_field physics plugin road scene sensor"
    " spherical_coordinates wind",
    "include": "plugin",
    "model": "allow_auto_disable enable_wind frame gripper joint plugin self_collide",
    "link": "audio_sink audio_source battery enable_wind frame gravity inertial kinematic light must_be_base_link"
    " particle_emitter projector self_collide sensor velocity_decay visual",
    "collision": "frame laser_retro max_contacts surface",
}
# Plugins of a <world> that belong to the simulator, such as gz-sim-physics-system: without effect here.
_OF_SIMULATOR = re.compile(r"(lib)?((gz-sim|ignition-gazebo)\d?-.*system|gazebo_ros_(factory|init|state|api|force))")
# Models of Gazebo that may be included without having their files; None: without effect here.
_BUILT_IN: Mapping[str, Optional[bytes]] = {
    "sun": None,
    "ground_plane": b"""<sdf version="1.6"><model name="ground_plane"><static>true</static><link name="link">
    <collision name="collision"><geometry><plane/></geometry></collision></link></model></sdf>""",
}


def read_world(path: str) -> World:
    """The world in an SDF file (1.4 and later) that contains one <world>, or one <model> such as a model.sdf.

    WorldError names the file, line and element, what is wrong with it, and what is supported.
    """
    root = xml.root_of(xml.parse(path), ("world", "model"))
    reader = _Reader(path)
    if root.tag == "model":
        reader.model(root, _Parent())
        return reader.world(xml.name_of(root))
    reader.check_children(root, "frame", "include", "model", "state")
    reader.state = state_poses(root, reader.report)
    reader.spawn, reader.keeps_robots = _spawn(root), False
    reader.children(root, _Parent())
    return reader.world(xml.name_of(root))


def read_model(root: Element, name: str, pose: Pose3D) -> World:
    """A world that contains only the <model> of an <sdf>, at another pose and under a name; empty: its own name."""
    reader = _Reader(file_of(root))
    return reader.world(reader.model(xml.root_of(root, ("model",)), _Parent(), new_name=name, new_pose=pose))


def _spawn(world: Element) -> Optional[Pose2D]:
    """The pose of this package's <frame> for the robot's start, if the world has one."""
    spawns = world.findall(f"frame[@name='{SPAWN_FRAME}']")
    if not spawns:
        return None
    if len(spawns) > 1:
        raise xml.error(spawns[1], f"a second <frame name='{SPAWN_FRAME}'>; supported: one")
    if spawns[0].get("attached_to", "world") not in ("", "world"):
        raise xml.error(spawns[0], f"<frame name='{SPAWN_FRAME}'> is attached to a model; supported: to the world")
    pose = xml.pose_in_world(spawns[0])
    if not 0.0 <= pose.position[2] <= MAX_TOP or not pose.is_upright():
        supported = f"<pose>x y z 0 0 yaw</pose>, z up to {MAX_TOP:g}"
        raise xml.error(spawns[0], f"'{SPAWN_FRAME}' is not on the ground; supported: {supported}")
    return pose.on_plane()


@dataclass(frozen=True)
class _Parent:
    """What an element inherits from the models and links around it.

    pose: world_from_parent
    names: of the models and links, the outermost first
    motion: the scripted motion of the innermost model that has one
    static: whether one of the models is
    """

    pose: Pose3D = Pose3D()
    names: Tuple[str, ...] = ()
    motion: Optional[Motion] = None
    static: bool = False


class _Reader:
    """Collects the contents of one world and of the files that it includes."""

    def __init__(self, path: str) -> None:
        self.path = path
        self.obstacles: List[Obstacle] = []
        self.models: Dict[str, Pose3D] = {}
        self.ignored: List[str] = []
        self.approximated: List[str] = []
        self.used: Set[Tuple[str, ...]] = set()  # paths of models, links, collisions: names, the outermost's first
        self.count = 0  # of models
        self.state: SavedPoses = {}
        self.spawn: Optional[Pose2D] = None  # as the file says
        self.keeps_robots = True
        self.saved_robot: Optional[Pose2D] = None  # the first one that is left out
        self.triangles: Dict[str, np.ndarray] = {}  # of the mesh files, by path
        self.open_files = [os.path.realpath(path)]  # the world's file and the chain of includes being read

    def world(self, name: str) -> World:
        """The world with everything read so far."""
        return World(
            name,
            tuple(self.obstacles),
            self.spawn or self.saved_robot or Pose2D(),
            tuple(dict.fromkeys(self.ignored)),
            self.path,
            self.models,
            has_spawn=self.spawn is not None,
            has_saved_robot=self.saved_robot is not None,
            approximated=tuple(dict.fromkeys(self.approximated)),
        )

    def report(self, what: str, element: Element, is_different: bool = False) -> None:
        """Add an element to the world's `ignored`, or to its `approximated`, with its line and an included file."""
        file = file_of(element)
        line = f"line {element.sourceline}" if file == self.path else f"{file}:{element.sourceline}"
        (self.approximated if is_different else self.ignored).append(f"{what} ({line})")

    def check_children(self, element: Element, *read: str) -> None:
        """Report plugins, and children that are neither read nor known to be unused."""
        for child in xml.unknown_children(element, (*read, *_UNUSED[element.tag].split())):
            self.report(f"{xml.title_of(child)} in <{element.tag}> is left out", child, is_different=True)
        for plugin in element.iterchildren("plugin"):
            is_ours = element.tag == "model" and is_motion(plugin)
            is_simulator = element.tag == "world" and _OF_SIMULATOR.match(str(plugin.get("filename", "")))
            if not (is_ours or is_simulator):
                self.report(f"plugin '{plugin.get('name', '')}'", plugin)

    def children(self, element: Element, parent: _Parent) -> None:
        """Read the models and includes in a <world> or a <model>."""
        if len(parent.names) > MAX_DEPTH:
            raise xml.error(element, f"more than {MAX_DEPTH} models within each other; supported: {MAX_DEPTH}")
        for child in element.iterchildren("include", "model"):
            if child.tag == "include":
                self.include(child, parent)
            else:
                self.model(child, parent)

    def include(self, include: Element, parent: _Parent) -> None:
        """Read the model that an <include> refers to."""
        self.check_children(include, "name", "pose", "static", "uri")
        uri = xml.text_of(xml.required_child(include, "uri"))
        name = xml.optional_child(include, "name")
        pose = xml.optional_child(include, "pose")
        new_name = "" if name is None else xml.text_of(name)
        new_pose = None if pose is None else frames.placed(include, parent.pose)
        static = xml.boolean(include, "static")
        model_name = uris.model_name(uri)
        if model_name in _BUILT_IN:
            content = _BUILT_IN[model_name]
            if content is not None:
                model = xml.root_of(parse_xml(content, uri, WorldError), ("model",))
                self.model(model, parent, include, new_name, new_pose, static)
            return
        if is_robot_name(model_name) and self.may_be_robot(parent, static):
            self.leave_out_robot(new_name or model_name, parent, new_pose or parent.pose, include)
            return
        try:
            with xml.about(include):
                path = uris.locate_model(uri, file_of(include))
        except xml.NotSimulatedError as exc:
            self.report(f"an include is left out: {exc}", include, is_different=True)
            return
        if os.path.realpath(path) in self.open_files:
            raise xml.error(include, f"'{uri}' is {path} again, within itself; expected another model")
        self.open_files.append(os.path.realpath(path))
        try:
            root = xml.parse(path)
            if root.tag == "robot":
                self.report(f"an include is left out: '{uri}' is a URDF", include, is_different=True)
                return
            included = xml.root_of(root, ("actor", "light", "model"))
            if included.tag == "model":
                self.model(included, parent, include, new_name, new_pose, static)
        except WorldError as exc:
            raise WorldError(f"{exc}; included by {file_of(include)}:{include.sourceline}") from exc
        finally:
            self.open_files.pop()

    def model(
        self,
        model: Element,
        parent: _Parent,
        include: Optional[Element] = None,
        new_name: str = "",
        new_pose: Optional[Pose3D] = None,
        static: Optional[bool] = None,
    ) -> str:
        """Read a model, maybe an included one, with its links and nested models; returns its name.

        new_name, new_pose (in the world), static: in place of the model's own, unless empty or None
        """
        pose = frames.placed(model, parent.pose) if new_pose is None else new_pose
        static = xml.boolean(model, "static") if static is None else static
        if self.may_be_robot(parent, static) and is_robot(model):
            name = new_name or xml.name_of(model)
            self.leave_out_robot(name, parent, pose, model if include is None else include)
            return name
        self.check_children(model, "include", "link", "model", "pose", "static")
        if model.get("placement_frame"):
            self.report(f"placement_frame of model '{model.get('name')}' is left out", model, is_different=True)
        self.count += 1
        if self.count > MAX_MODELS:
            raise xml.error(model, f"more than {MAX_MODELS} models; supported: {MAX_MODELS}")
        name = self.unused_name(new_name or xml.name_of(model), parent, model, include)
        names = (*parent.names, name)
        pose = self.state.get("/".join(names), pose)
        if not parent.names:
            self.models[name] = pose
        motion = motion_of(model, pose) or parent.motion
        if not (static or parent.names or motion or any(it.startswith(MOTION) for it in self.ignored)):
            self.report(f"{MOTION}, such as '{name}'", model)
        inherited = _Parent(pose, names, motion, bool(static) or parent.static)
        for link in model.iterchildren("link"):
            self.link(link, inherited)
        self.children(model, inherited)
        return name

    def may_be_robot(self, parent: _Parent, static: Optional[bool]) -> bool:
        """Return whether a model of this parent is left out if it looks like a robot."""
        return not (self.keeps_robots or parent.static or static)

    def leave_out_robot(self, name: str, parent: _Parent, pose: Pose3D, element: Element) -> None:
        """Report a robot that was saved with the world, and keep the pose of the first one."""
        is_start = self.spawn is None and self.saved_robot is None
        starts = ", and a robot starts at its pose if there is room" if is_start else ""
        path = "/".join((*parent.names, name))
        self.report(f"the robot '{path}' is left out{starts}", element, is_different=True)
        self.saved_robot = self.saved_robot or self.state.get(path, pose).on_plane()

    def unused_name(self, name: str, parent: _Parent, element: Element, include: Optional[Element] = None) -> str:
        """The name of a model, link or collision, with a number if something beside it has the same one."""
        unused, number = name, 0
        while (*parent.names, unused) in self.used:
            number += 1
            unused = f"{name}_{number}"
        if unused != name:
            what = f"the name '{name}' is already taken, so this {element.tag} is called '{unused}'"
            self.report(what, element if include is None else include, is_different=True)
        self.used.add((*parent.names, unused))
        return unused

    def link(self, link: Element, parent: _Parent) -> None:
        """Read a link's collisions."""
        self.check_children(link, "collision", "pose")
        names = (*parent.names, self.unused_name(xml.name_of(link), parent, link))
        pose = self.state.get("/".join(names), frames.placed(link, parent.pose))
        for collision in link.iterchildren("collision"):
            self.collision(collision, replace(parent, pose=pose, names=names))

    def collision(self, collision: Element, parent: _Parent) -> None:
        """Read one collision, unless its geometry is <empty>."""
        self.check_children(collision, "geometry", "pose")
        name = "/".join((*parent.names, self.unused_name(xml.name_of(collision), parent, collision)))
        shape = xml.required_child(collision, "geometry")
        try:
            geometry = read_shape(shape, self.triangles)
        except xml.NotSimulatedError as exc:
            self.report(f"'{name}' is left out: {exc}", shape, is_different=True)
            return
        if geometry is None:
            return
        pose = frames.placed(collision, parent.pose)
        if parent.motion is not None:
            require_movable_shape(collision, geometry, pose)
        self.obstacles.append(Obstacle(name, pose, geometry, parent.motion))
