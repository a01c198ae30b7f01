"""What a world is made of: obstacles, each a geometry at a pose."""

from dataclasses import dataclass, field, replace
from typing import Dict, Mapping, Optional, Tuple, Union

import numpy as np

from .geometry import Pose2D, Pose3D, Vector3, lifted
from .motion import Motion


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


@dataclass(frozen=True, eq=False)
class Mesh:
    """Triangles, met from both sides: corners (n, 3, 3) [m] in the obstacle's frame; file: where they come from."""

    corners: np.ndarray
    file: str


@dataclass(frozen=True, eq=False)
class Walls:
    """Upright faces without thickness, met from both sides, such as the outlines of a map's occupied cells.

    segments: (n, [start, end], [x, y]) [m] in the obstacle's frame, at its z = 0; height: up to there [m]
    """

    segments: np.ndarray
    height: float


Geometry = Union[Box, Cylinder, Sphere, Plane, Mesh, Walls]


@dataclass(frozen=True, eq=False)
class Occupancy:
    """A grid map, as nav_msgs/OccupancyGrid has it.

    cells: (rows, columns) int8, -1 unknown, 0 free to 100 occupied; row 0, column 0 lies at the origin
    resolution: [m] of a cell
    origin: map_from_grid, the pose of the outer corner of cell (0, 0), columns along its x and rows along its y
    """

    cells: np.ndarray
    resolution: float
    origin: Pose2D


@dataclass(frozen=True)
class Obstacle:
    """Something that robots bump into and scans see.

    name: `model/link/collision`, unique in its world; nested models come first, as in `house/door/link/collision`
    pose: world_from_obstacle, the centre of the geometry (for a Plane: a point on it) in the world frame [m]
    motion: how it moves from there; None: it stands still for ever
    """

    name: str
    pose: Pose3D
    geometry: Geometry
    motion: Optional[Motion] = None

    def at(self, time: float) -> Pose3D:
        """world_from_obstacle at a time [s]; it only moves on the plane."""
        if self.motion is None:
            return self.pose
        x, y, z = self.pose.position
        moved = self.motion.carry(Pose2D(x, y, self.pose.on_plane().yaw), time)
        return lifted(moved, z)


def _nowhere() -> Dict[str, Pose3D]:
    return {}


@dataclass(frozen=True)
class World:
    """What a world file says about the robot's surroundings.

    obstacles: in the file's order, the ground among them
    spawn: world_from_base_footprint at the start [m, rad]
    ignored: what was left out and could be missed, once each, such as "light 'sun' (line 4)"
    path: the file, as it was given to load_world
    models: world_from_model of each model [m]; its obstacles' names start with its own
    occupancy: the grid map that the world was made of, if it was
    """

    name: str
    obstacles: Tuple[Obstacle, ...]
    spawn: Pose2D
    ignored: Tuple[str, ...]
    path: str
    models: Mapping[str, Pose3D] = field(default_factory=_nowhere)
    occupancy: Optional[Occupancy] = None

    def moving(self) -> Tuple[Obstacle, ...]:
        """The obstacles that move."""
        return tuple(obstacle for obstacle in self.obstacles if obstacle.motion is not None)

    def standing(self) -> "World":
        """The same world, in which nothing moves."""
        return replace(self, obstacles=tuple(
            obstacle if obstacle.motion is None else replace(obstacle, motion=None) for obstacle in self.obstacles))
