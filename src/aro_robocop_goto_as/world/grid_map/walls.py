"""Make a world of a map_server map by extruding its occupied cells to walls."""

import math
import os

import numpy as np

from ...geometry import Pose2D, Pose3D, lifted
from ..model import Obstacle, Occupancy, Plane, Walls, World
from .cells import read_cells
from .map_file import MapSpec, read_spec

WALL_HEIGHT = 0.5  # [m], as in the worlds of this package


def read_map(path: str) -> World:
    """The world of a map's YAML file: walls around its occupied cells, on an infinite floor.

    Unknown cells are neither walls nor free. WorldError as read_spec and read_cells.
    """
    spec = read_spec(path)
    occupancy = Occupancy(read_cells(spec), spec.resolution, spec.origin)
    walls = Walls(outline(occupancy.cells >= _lowest_wall(spec)) * spec.resolution, WALL_HEIGHT)
    obstacles = (
        Obstacle("ground_plane/link/collision", Pose3D(), Plane((0.0, 0.0, 1.0))),
        Obstacle("map/walls/collision", lifted(spec.origin), walls),
    )
    name = os.path.splitext(os.path.basename(path))[0]
    ignored = tuple(f"key '{key}' of the map" for key in spec.unknown)
    return World(name, obstacles, Pose2D(), ignored, path, occupancy=occupancy, has_spawn=False)


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
