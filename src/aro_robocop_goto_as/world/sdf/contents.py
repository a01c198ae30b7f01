"""The contents of an SDF file read so far: obstacles, models, and notes on elements that are left out or differ."""

import os
import re
from dataclasses import dataclass
from typing import Dict, Iterator, List, Mapping, Optional, Set, Tuple

import numpy as np

from ...geometry import Pose2D, Pose3D
from ...reading import Element, file_of
from ..model import Obstacle, World
from ..scripted_motion import Motion
from . import xml
from .motion_plugin import is_motion
from .state import SavedPoses

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


@dataclass(frozen=True)
class Parent:
    """The properties that an element inherits from the models and links around it.

    pose: world_from_parent
    names: of the models and links, the outermost first
    motion: the scripted motion of the innermost model that has one
    static: whether one of the models is
    """

    pose: Pose3D = Pose3D()
    names: Tuple[str, ...] = ()
    motion: Optional[Motion] = None
    static: bool = False


class Contents:
    """The contents of one world, with the files that it includes."""

    def __init__(self, path: str) -> None:
        self.path = path
        self.obstacles: List[Obstacle] = []
        self.models: Dict[str, Pose3D] = {}
        self.ignored: List[str] = []
        self.approximated: List[str] = []
        self.missing: Dict[str, str] = {}  # models without a folder on this machine: where the first use of each is
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
            approximated=tuple(dict.fromkeys([*self.approximated, *self._missing_models()])),
        )

    def _missing_models(self) -> Iterator[str]:
        """One text about all models that are not on this machine, as with Gazebo without network; none if all are."""
        if self.missing:
            names = ", ".join(f"{name} ({place})" for name, place in self.missing.items())
            yield (
                f"models that are not on this machine are left out: {names}; to have them, put their folders beside "
                "the world file or into ~/.gazebo/models; those of Gazebo are at "
                "https://github.com/osrf/gazebo_models"
            )

    def note(self, what: str, element: Element, is_different: bool = False) -> None:
        """Add an element to the world's `ignored`, or to its `approximated`, with its line and an included file."""
        (self.approximated if is_different else self.ignored).append(f"{what} ({self._place(element)})")

    def leave_out(self, what: str, reason: xml.NotSimulatedError, element: Element) -> None:
        """Report an include or a collision that is not simulated."""
        if isinstance(reason, xml.MissingModelError):
            self.missing.setdefault(reason.name, self._place(element))
        else:
            self.note(f"{what} is left out: {reason}", element, is_different=True)

    def _place(self, element: Element) -> str:
        file = file_of(element)
        return f"line {element.sourceline}" if file == self.path else f"{file}:{element.sourceline}"

    def check_children(self, element: Element, *read: str) -> None:
        """Report plugins, and children that are neither read nor known to be unused."""
        for child in xml.unknown_children(element, (*read, *_UNUSED[element.tag].split())):
            self.note(f"{xml.title_of(child)} in <{element.tag}> is left out", child, is_different=True)
        for plugin in element.iterchildren("plugin"):
            is_ours = element.tag == "model" and is_motion(plugin)
            is_simulator = element.tag == "world" and _OF_SIMULATOR.match(str(plugin.get("filename", "")))
            if not (is_ours or is_simulator):
                self.note(f"plugin '{plugin.get('name', '')}'", plugin)

    def may_be_robot(self, parent: Parent, static: Optional[bool]) -> bool:
        """Return whether a model of this parent is left out if it looks like a robot."""
        return not (self.keeps_robots or parent.static or static)

    def leave_out_robot(self, name: str, parent: Parent, pose: Pose3D, element: Element) -> None:
        """Report a robot that was saved with the world, and keep the pose of the first one."""
        is_start = self.spawn is None and self.saved_robot is None
        starts = ", and a robot starts at its pose if there is room" if is_start else ""
        path = "/".join((*parent.names, name))
        self.note(f"the robot '{path}' is left out{starts}", element, is_different=True)
        self.saved_robot = self.saved_robot or self.state.get(path, pose).on_plane()

    def unused_name(self, name: str, parent: Parent, element: Element, include: Optional[Element] = None) -> str:
        """The name of a model, link or collision, with a number if something beside it has the same one."""
        unused, number = name, 0
        while (*parent.names, unused) in self.used:
            number += 1
            unused = f"{name}_{number}"
        if unused != name:
            what = f"the name '{name}' is already taken, so this {element.tag} is called '{unused}'"
            self.note(what, element if include is None else include, is_different=True)
        self.used.add((*parent.names, unused))
        return unused
