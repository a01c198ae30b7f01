"""A map_server map -> World: its occupied cells extruded to walls."""

import math
import os
from typing import Iterator, Tuple

import numpy as np

from .errors import WorldError
from .geometry import Pose2D, Pose3D, compose, inverse, lifted
from .map_file import MapSpec, read_cells, read_spec
from .shapes import Obstacle, Occupancy, Plane, Walls, World

WALL_HEIGHT = 0.5  # [m], as the walls of the worlds that come with this package
ROOMS = (0.3, 0.12)  # [m] free to all sides where a robot starts: comfortable, or no more than a Burger needs


def read_map(path: str) -> World:
    """The world of a map's YAML file: walls around its occupied cells, on an infinite floor.

    The robot starts at the map's (0, 0), or at the free place nearest to there. Unknown cells are no walls, but not
    free either. WorldError as read_spec and read_cells, and where no robot fits.
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
    return World(name, obstacles, spawn, ignored, path, occupancy=occupancy)


def _lowest_wall(spec: MapSpec) -> int:
    """The lowest value of a cell that is a wall. Mode raw has values of its own making, others 100 above the bound."""
    return math.floor(100.0 * spec.occupied_thresh) + 1 if spec.mode == "raw" else 100


def outline(occupied: np.ndarray) -> np.ndarray:
    """The edges between occupied cells and others, joined to the longest segments: (n, [start, end], [x, y]) in cells.

    occupied: (rows, columns) of truth values; what is outside of it counts as not occupied.
    """
    rows, columns = occupied.shape
    framed = np.zeros((rows + 2, columns + 2), dtype=bool)
    framed[1:-1, 1:-1] = occupied
    along_x = _runs(framed[1:, 1:-1] != framed[:-1, 1:-1])
    along_y = _runs((framed[1:-1, 1:] != framed[1:-1, :-1]).T)
    return np.concatenate([along_x[..., ::-1], along_y]).astype(float)


def _runs(edges: np.ndarray) -> np.ndarray:
    """Runs of true values along the rows of (m, n): their [start, end] as [row, position], (k, 2, 2)."""
    rows, length = edges.shape
    framed = np.zeros((rows, length + 2), dtype=bool)
    framed[:, 1:-1] = edges
    turns = np.flatnonzero(framed[:, 1:] != framed[:, :-1])
    return np.stack([turns // (length + 1), turns % (length + 1)], axis=-1).reshape(-1, 2, 2)


def _spawn(occupancy: Occupancy, blocked: np.ndarray, path: str) -> Pose2D:
    """A place to start from, level with the world's axes; WorldError if there is none."""
    grid_from_world = inverse(occupancy.origin)
    target = np.floor(np.array([grid_from_world.x, grid_from_world.y]) / occupancy.resolution) + 0.5
    for room in ROOMS:
        reach = math.ceil(room / occupancy.resolution)
        for column, row in _clear_cell_nearest(blocked, reach, target):
            if (column + 0.5, row + 0.5) == tuple(target):
                return Pose2D()
            centre = Pose2D((column + 0.5) * occupancy.resolution, (row + 0.5) * occupancy.resolution)
            found = compose(occupancy.origin, centre)
            return Pose2D(found.x, found.y)
    raise WorldError(f"{path}: the map has no free place of {2.0 * ROOMS[-1]:g} m across, which a robot needs to start")


def _clear_cell_nearest(blocked: np.ndarray, reach: int, target: np.ndarray) -> Iterator[Tuple[int, int]]:
    """The cell (column, row) nearest to a point in cells with no blocked one within `reach` cells; none if none is.

    By sums over squares: how many blocked cells a square holds tells four entries of the running sums.
    """
    size = 2 * reach + 1
    if min(blocked.shape) < size:
        return
    sums = np.zeros((blocked.shape[0] + 1, blocked.shape[1] + 1), dtype=np.int32)
    np.cumsum(np.cumsum(blocked, axis=0, dtype=np.int32), axis=1, out=sums[1:, 1:])
    held = sums[size:, size:] - sums[:-size, size:] - sums[size:, :-size] + sums[:-size, :-size]
    rows, columns = (np.arange(n, dtype=np.float32) + reach + 0.5 for n in held.shape)
    away = np.where(held == 0, (rows[:, None] - target[1]) ** 2 + (columns - target[0]) ** 2, np.inf)
    best = int(np.argmin(away))
    if np.isfinite(away.flat[best]):
        yield best % held.shape[1] + reach, best // held.shape[1] + reach
