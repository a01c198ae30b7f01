"""World + robots' poses -> what the scanners of all of them are exactly away from."""

import math
from typing import Dict, List, Sequence, Tuple

import numpy as np

from .geometry import Pose2D, compose
from .robot import RobotModel
from .sensors.lidar import Lidar
from .shapes import Box, Cylinder, Obstacle, World
from .slice import Slice


def rounds_at(model: RobotModel, height: float) -> np.ndarray:
    """The circles (k, [x, y, radius]) [m] in base_footprint that a robot is to scanners at a height [m].

    Cylinders are exact; a box stands for the circle of the same area, as it turns with its robot.
    """
    found: List[Tuple[float, float, float]] = []
    for obstacle in model.collisions:
        x, y, z = obstacle.pose.position
        radius = _radius_at(obstacle, height - z)
        if radius > 0.0:
            found.append((x, y, radius))
    return np.array(found).reshape(-1, 3)


def _radius_at(obstacle: Obstacle, above: float) -> float:
    """Of the circle that an upright shape is at a height [m] above its middle; 0 where it is not met."""
    shape = obstacle.geometry
    if isinstance(shape, Box):
        return math.sqrt(shape.size[0] * shape.size[1] / math.pi) if abs(above) < shape.size[2] / 2.0 else 0.0
    if isinstance(shape, Cylinder):
        return shape.radius if abs(above) < shape.length / 2.0 else 0.0
    return 0.0  # spheres are wheels and casters, within the outline of the rest


class _Level:
    """The scanners at one height: the world's cut there, and what each robot is to them."""

    def __init__(self, height: float, models: Sequence[RobotModel], world: World) -> None:
        self.height = height
        self.walls = Slice(world, height)
        rounds = [rounds_at(model, height) for model in models]
        self.counts = [len(it) for it in rounds]
        self._owners = np.repeat(np.arange(len(models)), self.counts)  # of each circle, its robot
        self._x, self._y, self._radius = np.concatenate(rounds).T

    def others(self, world_from_bases: np.ndarray, robots: Sequence[int]) -> np.ndarray:
        """Circles (r, k, 3) [m] in the world that stand for the others of each of these robots, equal in count."""
        x, y, yaw = world_from_bases[self._owners].T
        c, s = np.cos(yaw), np.sin(yaw)
        circles = np.column_stack([x + c * self._x - s * self._y, y + s * self._x + c * self._y, self._radius])
        return np.stack([circles[self._owners != robot] for robot in robots])


class Scanners:
    """One scanner a robot, all of the same kind; robots of different models carry them at different heights."""

    def __init__(self, models: Sequence[RobotModel], world: World) -> None:
        self._base_from_scans = [model.base_from_scan.on_plane() for model in models]
        levels: Dict[float, _Level] = {}
        for model in models:
            if model.scan_height not in levels:
                levels[model.scan_height] = _Level(model.scan_height, models, world)
        self._levels = [levels[model.scan_height] for model in models]

    def change_world(self, world: World) -> None:
        """Another world from now on."""
        for height in {level.height for level in self._levels}:
            walls = Slice(world, height)
            for level in self._levels:
                if level.height == height:
                    level.walls = walls

    def walls(self, robot: int) -> Slice:
        """The world's cut at the height of one robot's scanner, at time zero."""
        return self._levels[robot].walls

    def distances(self, lidar: Lidar, world_from_bases: Sequence[Pose2D], robots: Sequence[int],
                  time: float) -> np.ndarray:
        """Exact distances (r, samples) [m] of the robots asked for, at a time [s]; +inf where nothing is in reach.

        In the plane that TF speaks of: scanners level, at their height on robots that stand upright.
        """
        bases = np.array([(pose.x, pose.y, pose.yaw) for pose in world_from_bases])
        scans = [compose(world_from_bases[robot], self._base_from_scans[robot]) for robot in robots]
        poses = np.array([(pose.x, pose.y, pose.yaw) for pose in scans])
        groups: Dict[Tuple[float, int], List[int]] = {}  # rows of robots that see from one height as many circles
        for row, robot in enumerate(robots):
            level = self._levels[robot]
            groups.setdefault((level.height, level.counts[robot]), []).append(row)
        found = np.empty((len(robots), lidar.spec.samples))
        for rows in groups.values():
            level, seeing = self._levels[robots[rows[0]]], [robots[row] for row in rows]
            others = level.others(bases, seeing) if len(bases) > 1 else None
            found[rows] = lidar.distances(poses[rows], level.walls.at(time), others)
        return found
