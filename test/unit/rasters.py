"""Which places of a world are free, and which can be reached, on a raster."""

import numpy as np
import pytest

from aro_robocop_goto_as.floor_plan.occupancy import _reachable
from aro_robocop_goto_as.geometry import rotation_matrix
from aro_robocop_goto_as.shapes import Box, Plane

BURGER_RADIUS = 0.105  # [m]
CELL = 0.05  # [m] side of a raster cell
HALF = 160  # raster cells from the origin to each border: 8 m, outside of every wall


def clearance(world, points):
    """Distance [m] from each of the points (..., 2) [m] in the world frame to the nearest upright obstacle."""
    nearest = np.full(points.shape[:-1], np.inf)
    for obstacle in world.obstacles:
        if isinstance(obstacle.geometry, Plane):
            continue
        rotation = rotation_matrix(obstacle.pose.orientation)
        assert rotation[2, 2] == pytest.approx(1.0), f"{obstacle.name} is tilted"
        local = np.abs((points - obstacle.pose.position[:2]) @ rotation[:2, :2])
        if isinstance(obstacle.geometry, Box):
            outside = np.maximum(local - np.array(obstacle.geometry.size[:2]) / 2.0, 0.0)
            distance = np.linalg.norm(outside, axis=-1)
        else:
            distance = np.linalg.norm(local, axis=-1) - obstacle.geometry.radius
        nearest = np.minimum(nearest, distance)
    return nearest


def cell_of(x, y):
    return round(x / CELL) + HALF, round(y / CELL) + HALF


def flood(free, start):
    """Which raster cells can be reached from the start over free cells, by steps along x and y."""
    return _reachable(free, np.array([start[::-1]]))


def free_cells(world):
    axis = np.arange(-HALF, HALF + 1) * CELL
    return clearance(world, np.stack(np.meshgrid(axis, axis, indexing="ij"), axis=-1)) > BURGER_RADIUS
