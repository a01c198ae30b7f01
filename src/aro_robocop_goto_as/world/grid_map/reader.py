"""Make a world of a map_server map by extruding its occupied cells to walls."""

import math
import os

import numpy as np

from ...geometry import Pose2D, Pose3D, lifted
from ..model import Obstacle, Occupancy, Plane, Walls, World
from .image import read_image
from .map_file import MapSpec, read_spec

WALL_HEIGHT = 0.5  # [m], as in the worlds of this package


def read_map(path: str) -> World:
    """The world of a map's YAML file: walls around its occupied cells, on an infinite floor.

    Unknown cells are neither walls nor free. WorldError as read_spec and read_image.
    """
    spec = read_spec(path)
    occupancy = Occupancy(_read_cells(spec), spec.resolution, spec.origin)
    # In mode raw, the values are the image's own, and the threshold counts.
    lowest_wall = math.floor(100.0 * spec.occupied_thresh) + 1 if spec.mode == "raw" else 100
    walls = Walls(edges_of_cells(occupancy.cells >= lowest_wall) * spec.resolution, WALL_HEIGHT)
    obstacles = (
        Obstacle("ground_plane/link/collision", Pose3D(), Plane((0.0, 0.0, 1.0))),
        Obstacle("map/walls/collision", lifted(spec.origin), walls),
    )
    name = os.path.splitext(os.path.basename(path))[0]
    ignored = tuple(f"key '{key}' of the map" for key in spec.unknown)
    return World(name, obstacles, Pose2D(), ignored, path, occupancy=occupancy, has_spawn=False)


def _read_cells(spec: MapSpec) -> np.ndarray:
    """A map's image as the cells that map_server would publish: (rows, columns) int8, the image's last row first.

    -1 unknown, 0 free to 100 occupied; in mode raw whatever the image holds. WorldError as read_image.
    """
    pixels = read_image(spec.image)
    if pixels.shape[-1] == 1:  # the usual map: look the 256 greys up in a table
        cells = _cells(np.arange(256, dtype=np.uint8)[:, None], spec)[pixels[..., 0]]
    else:
        cells = _cells(pixels, spec)
    return np.ascontiguousarray(cells[::-1])


def _cells(pixels: np.ndarray, spec: MapSpec) -> np.ndarray:
    """Cell values (...) int8 of pixels (..., channels) uint8, with the arithmetic of map_server's image_loader.

    In mode trinary all channels are averaged, alpha included. Else the last of several is left out. In mode scale a
    pixel between the thresholds that is not opaque is unknown, as wiki.ros.org/map_server documents it. The last of
    three channels counts as alpha as well in map_server; there, such a pixel is unknown if it is 0.
    """
    shaded = spec.mode != "trinary" and pixels.shape[-1] > 1
    greys = (pixels[..., :-1] if shaded else pixels).mean(axis=-1)
    if spec.negate:
        greys = 255.0 - greys
    if spec.mode == "raw":
        return greys.astype(np.uint8).view(np.int8)  # values above 127 become negative
    occupied = (255.0 - greys) / 255.0
    between = np.full(greys.shape, -1.0)
    if spec.mode == "scale":
        span = max(spec.occupied_thresh - spec.free_thresh, 1e-9)
        between = np.floor(1.0 + 98.0 * ((occupied - spec.free_thresh) / span))
        if shaded:
            between[pixels[..., -1] < (255 if pixels.shape[-1] == 4 else 1)] = -1.0
    cells = np.where(occupied > spec.occupied_thresh, 100.0, np.where(occupied < spec.free_thresh, 0.0, between))
    return cells.astype(np.int8)


def edges_of_cells(occupied: np.ndarray) -> np.ndarray:
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
