"""Read the worlds and models of SDF files; only their collisions are kept, because robots can touch nothing else."""

import os
from dataclasses import replace
from typing import Mapping, Optional

from ...errors import WorldError
from ...geometry import Pose2D, Pose3D
from ...reading import Element, file_of, parse_xml
from ..ground import MAX_TOP
from ..model import Obstacle, World
from . import frames, uris, xml
from .contents import Contents, Parent
from .motion_plugin import motion_of, require_movable_shape
from .saved_robot import is_robot, is_robot_name
from .shapes import read_shape
from .state import state_poses

SPAWN_FRAME = "robot_spawn"
MOTION = "motion of models that are not static"
MAX_DEPTH = 20  # of models within models
MAX_MODELS = 5000  # as a file that includes another one twice, which includes a third one twice, ...

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
        reader.model(root, Parent())
        return reader.world(xml.name_of(root))
    reader.check_children(root, "frame", "include", "model", "state")
    reader.state = state_poses(root, reader.note)
    reader.spawn, reader.keeps_robots = _spawn(root), False
    reader.children(root, Parent())
    return reader.world(xml.name_of(root))


def read_model(root: Element, name: str, pose: Pose3D) -> World:
    """A world that contains only the <model> of an <sdf>, at another pose and under a name; empty: its own name."""
    reader = _Reader(file_of(root))
    return reader.world(reader.model(xml.root_of(root, ("model",)), Parent(), new_name=name, new_pose=pose))


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


class _Reader(Contents):
    """Reads the elements of one world and of the files that it includes."""

    def children(self, element: Element, parent: Parent) -> None:
        """Read the models and includes in a <world> or a <model>."""
        if len(parent.names) > MAX_DEPTH:
            raise xml.error(element, f"more than {MAX_DEPTH} models within each other; supported: {MAX_DEPTH}")
        for child in element.iterchildren("include", "model"):
            if child.tag == "include":
                self.include(child, parent)
            else:
                self.model(child, parent)

    def include(self, include: Element, parent: Parent) -> None:
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
            self.leave_out("an include", exc, include)
            return
        if os.path.realpath(path) in self.open_files:
            raise xml.error(include, f"'{uri}' is {path} again, within itself; expected another model")
        self.open_files.append(os.path.realpath(path))
        try:
            root = xml.parse(path)
            if root.tag == "robot":
                self.note(f"an include is left out: '{uri}' is a URDF", include, is_different=True)
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
        parent: Parent,
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
            self.note(f"placement_frame of model '{model.get('name')}' is left out", model, is_different=True)
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
            self.note(f"{MOTION}, such as '{name}'", model)
        inherited = Parent(pose, names, motion, bool(static) or parent.static)
        for link in model.iterchildren("link"):
            self.link(link, inherited)
        self.children(model, inherited)
        return name

    def link(self, link: Element, parent: Parent) -> None:
        """Read a link's collisions."""
        self.check_children(link, "collision", "pose")
        names = (*parent.names, self.unused_name(xml.name_of(link), parent, link))
        pose = self.state.get("/".join(names), frames.placed(link, parent.pose))
        for collision in link.iterchildren("collision"):
            self.collision(collision, replace(parent, pose=pose, names=names))

    def collision(self, collision: Element, parent: Parent) -> None:
        """Read one collision, unless its geometry is <empty>."""
        self.check_children(collision, "geometry", "pose")
        name = "/".join((*parent.names, self.unused_name(xml.name_of(collision), parent, collision)))
        shape = xml.required_child(collision, "geometry")
        try:
            geometry = read_shape(shape, self.triangles)
        except xml.NotSimulatedError as exc:
            self.leave_out(f"'{name}'", exc, shape)
            return
        if geometry is None:
            return
        pose = frames.placed(collision, parent.pose)
        if parent.motion is not None:
            require_movable_shape(collision, geometry, pose)
        self.obstacles.append(Obstacle(name, pose, geometry, parent.motion))
