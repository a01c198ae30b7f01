"""What beam sensors on all robots see: the world at the sensors' heights, and each other's robots."""

import math
from typing import Dict, Sequence, Tuple

import numpy as np

from ..geometry import Pose3D
from ..robot.model import RobotModel
from ..shapes import Box, Cylinder, PlacedShape
from ..world.model import World
from .beams import BeamPlane, BeamScene
from .cross_section import NO_CIRCLES, CrossSection, outline

Mounts = Tuple[Pose3D, ...]  # base_from_sensor of each robot


def circles_at(model: RobotModel, height: float) -> np.ndarray:
    """The shape of a robot for beams at a height [m]: circles (k, [x, y, radius]) [m] in base_footprint.

    Cylinders are exact, and upright. Boxes are approximated by a circle of equal area, independent of yaw. Spheres are
    wheels and casters, inside the outline of the base, and left out.
    """
    circles = [NO_CIRCLES]
    for obstacle in model.collisions:
        shape = obstacle.geometry
        if isinstance(shape, Box):
            shape = Cylinder(math.sqrt(shape.size[0] * shape.size[1] / math.pi), shape.size[2])
        if isinstance(shape, Cylinder):
            circles.append(outline(PlacedShape(obstacle.name, Pose3D(obstacle.pose.position), shape), height)[1])
    return np.concatenate(circles)


class BeamScenes:
    """The scene of each kind of beam sensor, made of the world's cross-sections at the sensors' heights.

    Beams are level, at their sensor's height on an upright robot, as in TF.
    """

    def __init__(self, models: Sequence[RobotModel], world: World, footprints: np.ndarray) -> None:
        """footprints: (n, 3) x, y [m], yaw [rad] of all robots in the world, where they are when beams are cast."""
        self._models, self._footprints, self._time = tuple(models), footprints, 0.0
        self.change_world(world)

    def change_world(self, world: World) -> None:
        """Replace the world; the scenes of the old one are of no use any more."""
        self._world = world
        self._sections: Dict[float, CrossSection] = {}  # by height [m], made when first asked for
        self._scenes: Dict[Mounts, BeamScene] = {}

    def section(self, height: float) -> CrossSection:
        """The world's cross-section at a height [m], with moving obstacles where they are now."""
        if height not in self._sections:
            self._sections[height] = CrossSection(self._world, height)
            self._sections[height].move(self._time)
        return self._sections[height]

    def scene(self, mounts: Mounts) -> BeamScene:
        """What sensors with these mounts see, one on each robot; models differ in the height of a sensor."""
        if mounts not in self._scenes:
            heights = [model.height_of(mount) for model, mount in zip(self._models, mounts)]
            levels, planes = sorted(set(heights)), []
            for height in levels:
                circles = [circles_at(model, height) for model in self._models]
                owners = np.repeat(np.arange(len(circles)), [len(of_one) for of_one in circles])
                planes.append(BeamPlane(self.section(height), np.concatenate(circles), owners))
            poses = np.array([mount.on_plane() for mount in mounts], dtype=float).reshape(-1, 3)
            self._scenes[mounts] = BeamScene(planes, [*map(levels.index, heights)], poses, self._footprints)
        return self._scenes[mounts]

    def move(self, time: float) -> None:
        """Put moving obstacles where they are at a time [s]."""
        self._time = time
        for section in self._sections.values():
            section.move(time)
