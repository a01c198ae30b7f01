"""The distance from a point on the floor to the nearest obstacle within a robot's height."""

import math
from dataclasses import replace
from typing import NamedTuple, Tuple

import numpy as np

from ..raycast.cross_section import NO_CIRCLES, NO_SEGMENTS, outline
from ..shapes import Mesh, Plane
from ..world.model import World

REACH = 0.5  # [m] only segments within this distance along y are searched at first, and all only if none is nearer


class NearestObstacle(NamedTuple):
    """The obstacle nearest to a point: its distance [m], 0 within it, and its name; +inf and empty for none."""

    distance: float
    name: str


class ObstacleDistance:
    """A world's obstacles at several heights [m], as they are at a time [s].

    Boxes, cylinders, spheres and the walls of a map are solid; a mesh or a plane is only its surface.
    """

    def __init__(self, world: World, heights: Tuple[float, ...], time: float = 0.0) -> None:
        placed = [replace(obstacle, pose=obstacle.at(time)) for obstacle in world.obstacles]
        outlines = [outline(obstacle, height) for obstacle in placed for height in heights]
        self._names = [obstacle.name for obstacle in placed for _ in heights]  # of the outlines
        is_solid = [not isinstance(obstacle.geometry, (Mesh, Plane)) for obstacle in placed for _ in heights]
        self._is_solid = np.array(is_solid, dtype=bool)
        self._start, end = np.moveaxis(np.concatenate([NO_SEGMENTS, *(segments for segments, _ in outlines)]), 1, 0)
        self._along = end - self._start
        self._low, self._high = np.minimum(self._start, end)[:, 1], np.maximum(self._start, end)[:, 1]
        self._squares = np.maximum((self._along**2).sum(axis=1), 1e-18)
        self._circles = np.concatenate([NO_CIRCLES, *(circles for _, circles in outlines)])
        sizes = [len(part[kind]) for kind in (0, 1) for part in outlines]  # of the segments, then of the circles
        self._owners = np.repeat(2 * list(range(len(outlines))), np.array(sizes, dtype=int))

    def nearest(self, x: float, y: float) -> NearestObstacle:
        """The obstacle nearest to a point [m] in the world."""
        near = np.flatnonzero((self._low <= y + REACH) & (self._high >= y - REACH))
        found = self._nearest(x, y, near)
        return found if found.distance <= REACH else self._nearest(x, y, np.arange(len(self._start)))

    def _nearest(self, x: float, y: float, rows: np.ndarray) -> NearestObstacle:
        """The nearest of all circles and of the segments in some rows, which include all segments that cross this y."""
        owners = np.concatenate([self._owners[rows], self._owners[len(self._start) :]])
        if not len(owners):
            return NearestObstacle(math.inf, "")
        from_start, along = np.array([x, y]) - self._start[rows], self._along[rows]
        share = np.clip((from_start * along).sum(axis=1) / self._squares[rows], 0.0, 1.0)
        gaps = np.hypot(*(from_start - share[:, None] * along).T)
        rounds = np.hypot(self._circles[:, 0] - x, self._circles[:, 1] - y) - self._circles[:, 2]
        distances = np.maximum(np.concatenate([gaps, rounds]), 0.0)
        distances[self._around(from_start, along, owners[: len(rows)])[owners]] = 0.0
        best = int(distances.argmin())
        return NearestObstacle(float(distances[best]), self._names[owners[best]])

    def _around(self, from_start: np.ndarray, along: np.ndarray, owners: np.ndarray) -> np.ndarray:
        """The solid outlines that contain a point: a ray from the point along x crosses them an odd number of times.

        from_start: (m, 2) [m] from the start of each segment to the point; along: to its end; owners: its outline
        """
        dx, dy = from_start.T
        upwards = along[:, 1]
        crosses = (dy >= 0.0) != (dy >= upwards)
        with np.errstate(divide="ignore", invalid="ignore"):
            crosses &= dx < along[:, 0] * (dy / upwards)
        counts = np.bincount(owners, weights=crosses, minlength=len(self._names))
        return (counts % 2 == 1) & self._is_solid
