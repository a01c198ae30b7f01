"""Make a world of a map_server map by extruding the edges of its occupied cells to walls."""

import math
import os

import numpy as np

from ...geometry import Pose2D, Pose3D, lifted, wrap_angle
from ...shapes import Plane, Walls
from ..model import Obstacle, Occupancy, World
from .image import read_cells
from .map_file import read_spec

WALL_HEIGHT = 0.5  # [m], as in the worlds of this package


def read_map(path: str) -> World:
    """The world of a map's YAML file: walls around its occupied cells, on an infinite floor.

    Unknown cells are neither walls nor free. WorldError as read_spec and read_image.
    """
    spec, unknown, different = read_spec(path)
    x, y, yaw = spec.origin
    occupancy = Occupancy(read_cells(spec), spec.resolution, Pose2D(x, y, wrap_angle(yaw)))
    # In mode raw, the values are the image's own, and the threshold counts.
    lowest_wall = math.floor(100.0 * spec.occupied_thresh) + 1 if spec.mode == "raw" else 100
    walls = Walls(edges_of_cells(occupancy.cells >= lowest_wall) * spec.resolution, WALL_HEIGHT)
    obstacles = (
        Obstacle("ground_plane/link/collision", Pose3D(), Plane((0.0, 0.0, 1.0))),
        Obstacle("map/walls/collision", lifted(occupancy.origin), walls),
    )
    name = os.path.splitext(os.path.basename(path))[0]
    ignored = tuple(f"key '{key}' of the map" for key in unknown)
    return World(
        name, obstacles, Pose2D(), ignored, path, occupancy=occupancy, has_spawn=False, approximated=tuple(different)
    )


def edges_of_cells(occupied: np.ndarray) -> np.ndarray:
    """The edges between occupied and other cells, merged into segments (n, [start, end], [x, y]) in units of cells.

    occupied: (rows, columns) bool; the outside of the map counts as not occupied.
    """
    framed = np.pad(occupied, 1)
    along_x, along_y = _runs(np.diff(framed, axis=0)[:, 1:-1]), _runs(np.diff(framed, axis=1)[1:-1].T)
    return np.concatenate([along_x[..., ::-1], along_y]).astype(float)


def _runs(edges: np.ndarray) -> np.ndarray:
    """Runs of true values in each row of (m, n): (k, [start, end], [row, column])."""
    rows, columns = np.nonzero(np.diff(np.pad(edges, ((0, 0), (1, 1)))))
    return np.stack([rows, columns], axis=-1).reshape(-1, 2, 2)
