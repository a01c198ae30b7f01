"""Exact distances seen by the scanners of all robots, which also see each other."""

import math
from typing import Sequence

import numpy as np

from ..geometry import Pose3D
from ..robot.model import RobotModel
from ..shapes import Box, Cylinder, PlacedShape
from ..world.model import World
from .beams import ScanPlane, Scene
from .cross_section import NO_CIRCLES, CrossSection, outline


def circles_at(model: RobotModel, height: float) -> np.ndarray:
    """The shape of a robot for a scanner at a height [m]: circles (k, [x, y, radius]) [m] in base_footprint.

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


class Scanners:
    """One scanner per robot, all of the same kind; models differ in the height of their scanner.

    scene: what they see, in the plane that TF describes: scanners are level, at their height on an upright robot
    """

    def __init__(self, models: Sequence[RobotModel], world: World, footprints: np.ndarray) -> None:
        """footprints: (n, 3) x, y [m], yaw [rad] of all robots in the world, where they are at each scan."""
        self._models, self._footprints = tuple(models), footprints
        self._heights = sorted({model.scan_height for model in models})
        self.change_world(world)

    def change_world(self, world: World) -> None:
        """Replace the world."""
        self._sections = [CrossSection(world, height) for height in self._heights]
        planes = []
        for height, section in zip(self._heights, self._sections):
            circles = [circles_at(model, height) for model in self._models]
            owners = np.repeat(np.arange(len(circles)), [len(of_one) for of_one in circles])
            planes.append(ScanPlane(section, np.concatenate(circles), owners))
        mounts = [model.base_from_scan.on_plane() for model in self._models]
        self._plane_of = [self._heights.index(model.scan_height) for model in self._models]
        self.scene = Scene(planes, self._plane_of, np.array(mounts, dtype=float).reshape(-1, 3), self._footprints)

    def section(self, robot: int) -> CrossSection:
        """The world's cross-section at the height of one robot's scanner."""
        return self._sections[self._plane_of[robot]]

    def move(self, time: float) -> None:
        """Put moving obstacles where they are at a time [s]; those of a new world are where they are at time zero."""
        for section in self._sections:
            section.move(time)
