"""Make a world of a map_server map by extruding its occupied cells to walls."""

import math
import os
from typing import Optional, Tuple

import numpy as np

from ...errors import WorldError
from ...geometry import Pose2D, Pose3D, compose, inverse, lifted
from ..model import Obstacle, Occupancy, Plane, Walls, World
from .map_file import MapSpec, read_cells, read_spec

WALL_HEIGHT = 0.5  # [m], as in the worlds of this package
SPAWN_CLEARANCES = (0.3, 0.13)  # [m] around the spawn: the preferred one, and the least for a Burger


def read_map(path: str) -> World:
    """The world of a map's YAML file: walls around its occupied cells, on an infinite floor.

    The robot starts at the map's (0, 0), or in the nearest cell with enough clearance. Unknown cells are neither walls
    nor free. WorldError as read_spec and read_cells, or if a robot fits nowhere.
    """
    spec = read_spec(path)
    occupancy = Occupancy(read_cells(spec), spec.resolution, spec.origin)
    occupied = occupancy.cells >= _lowest_wall(spec)
    walls = Walls(outline(occupied) * spec.resolution, WALL_HEIGHT)
    obstacles = (
        Obstacle("ground_plane/link/collision", Pose3D(), Plane((0.0, 0.0, 1.0))),
        Obstacle("map/walls/collision", lifted(spec.origin), walls),
    )
    name = os.path.splitext(os.path.basename(path))[0]
    spawn = _spawn(occupancy, occupied | (occupancy.cells < 0), path)
    ignored = tuple(f"key '{key}' of the map" for key in spec.unknown)
    return World(name, obstacles, spawn, ignored, path, occupancy=occupancy, has_spawn=False)


def _lowest_wall(spec: MapSpec) -> int:
    """The lowest cell value that is a wall: 100, or in mode raw, whose values are the image's own, the threshold."""
    return math.floor(100.0 * spec.occupied_thresh) + 1 if spec.mode == "raw" else 100


def outline(occupied: np.ndarray) -> np.ndarray:
    """The edges between occupied and other cells, merged into segments (n, [start, end], [x, y]) in units of cells.

    occupied: (rows, columns) bool; the outside of the map counts as not occupied.
    """
    rows, columns = occupied.shape
    framed = np.zeros((rows + 2, columns + 2), dtype=bool)
    framed[1:-1, 1:-1] = occupied
    along_x = _runs(framed[1:, 1:-1] != framed[:-1, 1:-1])
    along_y = _runs((framed[1:-1, 1:] != framed[1:-1, :-1]).T)
    return np.concatenate([along_x[..., ::-1], along_y]).astype(float)


def _runs(edges: np.ndarray) -> np.ndarray:
    """Runs of true values in each row of (m, n): (k, [start, end], [row, column])."""
    rows, length = edges.shape
    framed = np.zeros((rows, length + 2), dtype=bool)
    framed[:, 1:-1] = edges
    turns = np.flatnonzero(framed[:, 1:] != framed[:, :-1])
    return np.stack([turns // (length + 1), turns % (length + 1)], axis=-1).reshape(-1, 2, 2)


def _spawn(occupancy: Occupancy, blocked: np.ndarray, path: str) -> Pose2D:
    """The robot's starting pose, with yaw 0; WorldError if no cell has enough clearance."""
    grid_from_world = inverse(occupancy.origin)
    target = np.floor(np.array([grid_from_world.x, grid_from_world.y]) / occupancy.resolution) + 0.5
    for clearance in SPAWN_CLEARANCES:
        cell = _nearest_clear_cell(blocked, math.ceil(clearance / occupancy.resolution), target)
        if cell is not None:
            break
    else:
        diameter = 2.0 * SPAWN_CLEARANCES[-1]
        raise WorldError(f"{path}: the map has no free place of {diameter:g} m diameter, which a robot needs to start")
    column, row = cell
    if (column + 0.5, row + 0.5) == tuple(target):
        return Pose2D()
    centre = Pose2D((column + 0.5) * occupancy.resolution, (row + 0.5) * occupancy.resolution)
    spawn = compose(occupancy.origin, centre)
    return Pose2D(spawn.x, spawn.y)


def _nearest_clear_cell(blocked: np.ndarray, reach: int, target: np.ndarray) -> Optional[Tuple[int, int]]:
    """The cell (column, row) nearest to a point that has no blocked cell within `reach` cells, or None.

    A summed-area table gives the number of blocked cells in each square.
    """
    size = 2 * reach + 1
    if min(blocked.shape) < size:
        return None
    sums = np.zeros((blocked.shape[0] + 1, blocked.shape[1] + 1), dtype=np.int32)
    np.cumsum(np.cumsum(blocked, axis=0, dtype=np.int32), axis=1, out=sums[1:, 1:])
    counts = sums[size:, size:] - sums[:-size, size:] - sums[size:, :-size] + sums[:-size, :-size]
    rows, columns = (np.arange(n, dtype=np.float32) + reach + 0.5 for n in counts.shape)
    squared = np.where(counts == 0, (rows[:, None] - target[1]) ** 2 + (columns - target[0]) ** 2, np.inf)
    best = int(np.argmin(squared))
    if not np.isfinite(squared.flat[best]):
        return None
    return best % counts.shape[1] + reach, best // counts.shape[1] + reach
