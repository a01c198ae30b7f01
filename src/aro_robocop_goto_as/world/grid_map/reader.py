"""Make a world of a map_server map by extruding its occupied cells to walls."""

import math
import os

from ...geometry import Pose2D, Pose3D, lifted
from ...shapes import Plane, Walls
from ..model import Obstacle, Occupancy, World
from .cells import read_cells
from .edges import edges_of_cells
from .map_file import read_spec

WALL_HEIGHT = 0.5  # [m], as in the worlds of this package


def read_map(path: str) -> World:
    """The world of a map's YAML file: walls around its occupied cells, on an infinite floor.

    Unknown cells are neither walls nor free. WorldError as read_spec and read_image.
    """
    spec = read_spec(path)
    occupancy = Occupancy(read_cells(spec), spec.resolution, spec.origin)
    # In mode raw, the values are the image's own, and the threshold counts.
    lowest_wall = math.floor(100.0 * spec.occupied_thresh) + 1 if spec.mode == "raw" else 100
    walls = Walls(edges_of_cells(occupancy.cells >= lowest_wall) * spec.resolution, WALL_HEIGHT)
    obstacles = (
        Obstacle("ground_plane/link/collision", Pose3D(), Plane((0.0, 0.0, 1.0))),
        Obstacle("map/walls/collision", lifted(spec.origin), walls),
    )
    name = os.path.splitext(os.path.basename(path))[0]
    ignored = tuple(f"key '{key}' of the map" for key in spec.unknown)
    different = (spec.image_beside,) if spec.image_beside else ()
    return World(name, obstacles, Pose2D(), ignored, path, occupancy=occupancy, has_spawn=False, approximated=different)
