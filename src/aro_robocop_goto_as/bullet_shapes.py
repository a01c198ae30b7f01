"""Geometry -> Bullet's collision shapes."""

from typing import List

import numpy as np
import pybullet

from .shapes import Box, Cylinder, Geometry, Mesh, Plane, Sphere, Walls

MOST_TRIANGLES = 30000  # of one shape: pybullet refuses more than 131,072 corners


def shapes_of(geometry: Geometry, client: int) -> List[int]:
    """The shapes of a body that stands still; several only of more triangles than Bullet takes at once."""
    if isinstance(geometry, Mesh):
        return _pieces(geometry.corners, client)
    if isinstance(geometry, Walls):
        return _pieces(_wall_corners(geometry), client)
    return [_simple(geometry, client)]


def _wall_corners(walls: Walls) -> np.ndarray:
    """Two triangles (2 n, 3, 3) [m] for each of n walls.

    One body, however long the walls are: Bullet goes through its bodies at every step, but looks triangles up.
    """
    low = np.concatenate([walls.segments, np.zeros((len(walls.segments), 2, 1))], axis=-1)
    high = low + [0.0, 0.0, walls.height]
    (a, b), (c, d) = low.swapaxes(0, 1), high.swapaxes(0, 1)
    return np.stack([np.stack([a, b, c], axis=1), np.stack([b, d, c], axis=1)], axis=1).reshape(-1, 3, 3)


def _pieces(corners: np.ndarray, client: int) -> List[int]:
    pieces = range(0, len(corners), MOST_TRIANGLES)
    return [_triangles(corners[start : start + MOST_TRIANGLES], client) for start in pieces]


def _simple(geometry: Geometry, client: int) -> int:
    if isinstance(geometry, Box):
        return int(pybullet.createCollisionShape(pybullet.GEOM_BOX, halfExtents=[size / 2 for size in geometry.size],
                                                 physicsClientId=client))
    if isinstance(geometry, Cylinder):
        return int(pybullet.createCollisionShape(pybullet.GEOM_CYLINDER, radius=geometry.radius,
                                                 height=geometry.length, physicsClientId=client))
    if isinstance(geometry, Sphere):
        return int(pybullet.createCollisionShape(pybullet.GEOM_SPHERE, radius=geometry.radius, physicsClientId=client))
    if isinstance(geometry, Plane):
        return int(pybullet.createCollisionShape(pybullet.GEOM_PLANE, planeNormal=geometry.normal,
                                                 physicsClientId=client))
    raise TypeError(f"no shape for {geometry!r}")


def _triangles(corners: np.ndarray, client: int) -> int:
    """Triangles (n, 3, 3) [m] as they are, hollow, not their convex hull."""
    return int(pybullet.createCollisionShape(
        pybullet.GEOM_MESH, vertices=corners.reshape(-1, 3).tolist(), indices=list(range(3 * len(corners))),
        flags=pybullet.GEOM_FORCE_CONCAVE_TRIMESH, physicsClientId=client))
