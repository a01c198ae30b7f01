"""Geometry and robots -> what stands for them in Bullet: collision shapes, looks, bodies."""

import os
import tempfile
from typing import Any, Dict, List

import numpy as np
import pybullet

from .errors import RobotModelError
from .robot import RobotModel
from .shapes import Box, Cylinder, Geometry, Mesh, Plane, Sphere, Walls

MOST_TRIANGLES = 30000  # of one shape: pybullet refuses more than 131,072 corners
GROUND = (0.55, 0.55, 0.52, 1.0)  # of planes, red green blue alpha
SOLID = (0.62, 0.70, 0.80, 1.0)  # of all else, as in RViz
SIDES = 64  # of what a cylinder is seen as
HALF_PLANE = 100.0  # [m] half the side of the square that a plane is seen as


def load_urdf(model: RobotModel, client: int) -> int:
    """A robot's body, at the origin; RobotModelError where Bullet refuses it."""
    with tempfile.TemporaryDirectory(prefix="robocop_") as folder:
        path = os.path.join(folder, model.name + ".urdf")
        with open(path, "w") as stream:
            stream.write(model.physics_urdf)
        try:
            return int(pybullet.loadURDF(path, flags=pybullet.URDF_USE_INERTIA_FROM_FILE, physicsClientId=client))
        except pybullet.error as error:
            raise RobotModelError(f"{model.name}: Bullet refused the robot: {error}") from error


def look_of(geometry: Geometry, client: int) -> List[int]:
    """The visual shapes of a geometry, seen from both sides."""
    if isinstance(geometry, Mesh):
        return _looks(geometry.corners, SOLID, client)
    if isinstance(geometry, Walls):
        return _looks(_wall_corners(geometry), SOLID, client)
    if isinstance(geometry, Plane):
        return _looks(_square(np.array(geometry.normal)), GROUND, client)
    if isinstance(geometry, Cylinder):
        return _looks(_column(geometry), SOLID, client, both_sides=False)
    found: Dict[str, Any]
    if isinstance(geometry, Box):
        found = {"shapeType": pybullet.GEOM_BOX, "halfExtents": [size / 2 for size in geometry.size]}
    else:
        found = {"shapeType": pybullet.GEOM_SPHERE, "radius": geometry.radius}
    return [int(pybullet.createVisualShape(rgbaColor=SOLID, physicsClientId=client, **found))]


def _column(cylinder: Cylinder) -> np.ndarray:
    """Triangles (n, 3, 3) [m], seen from outside; Bullet's own cylinder is too coarse, its sides up to 2 cm off."""
    turns = 2.0 * np.pi * np.arange(SIDES + 1) / SIDES
    ring = np.column_stack([cylinder.radius * np.cos(turns), cylinder.radius * np.sin(turns), np.zeros(SIDES + 1)])
    up = np.array([0.0, 0.0, cylinder.length / 2.0])
    low, high = ring - up, ring + up
    a, b, c, d = low[:-1], low[1:], high[:-1], high[1:]
    middle = np.zeros_like(a)
    return np.concatenate([np.stack(part, axis=1) for part in (
        (a, b, d), (a, d, c), (c, d, middle + up), (b, a, middle - up))])


def _square(normal: np.ndarray) -> np.ndarray:
    """Two triangles (2, 3, 3) [m] about the origin that stand for a plane."""
    aside = np.cross(normal, [1.0, 0.0, 0.0] if abs(normal[0]) < 0.9 else [0.0, 1.0, 0.0])
    aside *= HALF_PLANE / np.linalg.norm(aside)
    along = np.cross(normal, aside)
    a, b, c, d = aside + along, along - aside, -aside - along, aside - along
    return np.array([[a, b, c], [a, c, d]])


def _looks(corners: np.ndarray, color: Any, client: int, both_sides: bool = True) -> List[int]:
    """Triangles (n, 3, 3) [m], seen from where their corners turn to the left, or each with its other side as well."""
    if both_sides:
        corners = np.stack([corners, corners[:, ::-1]], axis=1).reshape(-1, 3, 3)
    found = []
    for start in range(0, len(corners), MOST_TRIANGLES):
        piece = corners[start : start + MOST_TRIANGLES]
        edges = np.cross(piece[:, 1] - piece[:, 0], piece[:, 2] - piece[:, 0])
        normals = edges / np.maximum(np.linalg.norm(edges, axis=1, keepdims=True), 1e-30)
        found.append(int(pybullet.createVisualShape(
            pybullet.GEOM_MESH, vertices=piece.reshape(-1, 3).tolist(), indices=list(range(3 * len(piece))),
            normals=np.repeat(normals, 3, axis=0).tolist(), rgbaColor=color, physicsClientId=client)))
    return found


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
