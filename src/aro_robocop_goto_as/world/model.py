"""The model of a world: obstacles, each a shape at a pose."""

import math
from dataclasses import dataclass, field, replace
from typing import Mapping, Optional, Tuple

import numpy as np

from ..geometry import Pose2D, Pose3D, compose, inverse, lifted
from ..shapes import PlacedShape
from .scripted_motion import Motion


@dataclass(frozen=True, eq=False)
class Occupancy:
    """An occupancy grid, as in nav_msgs/OccupancyGrid.

    cells: (rows, columns) int8, -1 unknown, 0 free to 100 occupied; cell [0, 0] is at the origin. Other values come
        from maps in mode raw: above 100 is occupied, below 0 unknown
    resolution: side length of a cell [m]
    origin: map_from_grid, the pose of the outer corner of cell [0, 0]; columns run along its x, rows along its y
    """

    cells: np.ndarray
    resolution: float
    origin: Pose2D

    def is_known(self, x: float, y: float) -> bool:
        """Return whether a point [m] in the map is in a cell that is not unknown."""
        column, row = (math.floor(place) for place in self._in_cells(x, y))
        rows, columns = self.cells.shape
        return 0 <= column < columns and 0 <= row < rows and bool(self.cells[row, column] >= 0)

    def nearest_free(self, x: float, y: float) -> Tuple[float, float]:
        """The centre [m] in the map of the cell nearest to a point that is known and not occupied.

        If there is none, the centre of the first cell.
        """
        column, row = self._in_cells(x, y)
        rows, columns = (np.arange(count, dtype=np.float32) + 0.5 for count in self.cells.shape)
        squares = (rows[:, None] - row) ** 2 + (columns - column) ** 2
        squares[(self.cells < 0) | (self.cells >= 100)] = np.inf
        best_row, best_column = np.unravel_index(np.argmin(squares), squares.shape)
        in_grid = Pose2D(float(columns[best_column]) * self.resolution, float(rows[best_row]) * self.resolution)
        centre = compose(self.origin, in_grid)
        return centre.x, centre.y

    def _in_cells(self, x: float, y: float) -> Tuple[float, float]:
        """Column and row of a point [m] in the map, with fractions."""
        point = compose(inverse(self.origin), Pose2D(x, y))
        return point.x / self.resolution, point.y / self.resolution


@dataclass(frozen=True)
class Obstacle(PlacedShape):
    """Something that robots collide with and scanners see, at its pose in the world.

    name: `model/link/collision`, unique in its world; outer models come first, as in `house/door/link/collision`
    motion: how it moves as time passes; None: it never moves
    """

    motion: Optional[Motion] = None

    def at(self, time: float) -> Pose3D:
        """world_from_obstacle at a time [s]. A moving obstacle is assumed round: roll and pitch are dropped."""
        if self.motion is None:
            return self.pose
        x, y, z = self.pose.position
        moved = self.motion.carry(Pose2D(x, y, self.pose.on_plane().yaw), time)
        return lifted(moved, z)


@dataclass(frozen=True)
class World:
    """The surroundings of the robots, as a world file describes them.

    obstacles: in the file's order, the ground included
    spawn: world_from_footprint of a robot at the start [m, rad]
    has_spawn: whether the file gives it; otherwise it is the pose of the first robot that was saved with the world, or
        else the origin, and there may be no room for a robot
    has_saved_robot: whether a robot was saved with the world
    ignored: what may have an effect in Gazebo, such as "plugin 'lift' (line 4)"
    approximated: each element that differs from the file, such as "'hill/link/c' is left out: <heightmap> (line 4)"
    path: the file, as it was given to load_world
    ground: height [m] in the file of the ground, which is z = 0 of all poses here
    models: world_from_model of each model [m]; the names of its obstacles begin with the model's name
    occupancy: the grid map that the world was made from, if any
    """

    name: str
    obstacles: Tuple[Obstacle, ...]
    spawn: Pose2D
    ignored: Tuple[str, ...]
    path: str
    models: Mapping[str, Pose3D] = field(default_factory=dict)
    occupancy: Optional[Occupancy] = None
    has_spawn: bool = True
    has_saved_robot: bool = False
    ground: float = 0.0
    approximated: Tuple[str, ...] = ()

    def moving(self) -> Tuple[Obstacle, ...]:
        """The obstacles that move."""
        return tuple(obstacle for obstacle in self.obstacles if obstacle.motion is not None)

    def with_motion(self, enabled: bool) -> "World":
        """This world, at rest unless motion is enabled; obstacles that never move stay the same objects."""
        if enabled:
            return self
        return replace(
            self, obstacles=tuple(o if o.motion is None else replace(o, motion=None) for o in self.obstacles)
        )
