"""Create Bullet's collision shapes, visual shapes and bodies for geometries and robots."""

import os
import tempfile
from typing import Any, Dict, Iterator, List, Tuple, Union

import numpy as np

from ..errors import RobotModelError
from ..geometry import Pose3D
from ..robot.model import RobotModel
from ..shapes import Box, Cylinder, Geometry, Mesh, Plane, Sphere, Walls
from ..world.model import Obstacle
from .quiet_pybullet import pybullet

FLOOR = Obstacle("floor", Pose3D(), Plane((0.0, 0.0, 1.0)))
MAX_TRIANGLES = 30000  # per shape; pybullet refuses more than 131,072 vertices
GROUND = (0.55, 0.55, 0.52, 1.0)  # colour of planes, RGBA
SOLID = (0.62, 0.70, 0.80, 1.0)  # colour of everything else, as in RViz
SIDES = 64  # of the prism that shows a cylinder
HALF_PLANE = 100.0  # [m] half the side of the square that shows a plane


def load_urdf(model: RobotModel, client: int) -> Tuple[int, Pose3D]:
    """Create a robot's body at the origin; RobotModelError if Bullet refuses it.

    The body, and base_from_inertial: centre of mass and principal axes of base_link, which Bullet takes as its pose.
    """
    with tempfile.TemporaryDirectory(prefix="robocop_") as folder:
        path = os.path.join(folder, model.name + ".urdf")
        with open(path, "w") as stream:
            stream.write(model.physics_urdf)
        try:
            body = pybullet.loadURDF(path, flags=pybullet.URDF_USE_INERTIA_FROM_FILE, physicsClientId=client)
        except pybullet.error as error:
            raise RobotModelError(f"{model.name}: Bullet refused the robot: {error}") from error
    return body, Pose3D(*pybullet.getDynamicsInfo(body, -1, physicsClientId=client)[3:5])


def shapes_of(geometry: Geometry, client: int) -> List[int]:
    """Create the collision shapes of a static body; there are several only above MAX_TRIANGLES."""
    if not isinstance(geometry, (Mesh, Walls)):
        return [pybullet.createCollisionShape(**_primitive(geometry), physicsClientId=client)]
    hollow = pybullet.GEOM_FORCE_CONCAVE_TRIMESH  # instead of the triangles' convex hull
    return [
        pybullet.createCollisionShape(**mesh, flags=hollow, physicsClientId=client)
        for mesh in _meshes(_surface_triangles(geometry))
    ]


def visual_shapes(geometry: Geometry, client: int) -> List[int]:
    """Create the visual shapes of a geometry; planes, meshes and walls are visible from both sides."""
    if isinstance(geometry, (Box, Sphere)):
        return [pybullet.createVisualShape(**_primitive(geometry), rgbaColor=SOLID, physicsClientId=client)]
    if isinstance(geometry, Cylinder):
        corners, color = _cylinder_triangles(geometry), SOLID
    elif isinstance(geometry, Plane):
        corners, color = _both_sides(_plane_triangles(np.array(geometry.normal))), GROUND
    else:
        corners, color = _both_sides(_surface_triangles(geometry)), SOLID
    edges = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normals = edges / np.maximum(np.linalg.norm(edges, axis=1, keepdims=True), 1e-30)
    return [
        pybullet.createVisualShape(
            **mesh,
            normals=np.repeat(normals[start : start + MAX_TRIANGLES], 3, axis=0).tolist(),
            rgbaColor=color,
            physicsClientId=client,
        )
        for start, mesh in zip(range(0, len(corners), MAX_TRIANGLES), _meshes(corners))
    ]


def _primitive(geometry: Union[Box, Cylinder, Sphere, Plane]) -> Dict[str, Any]:
    """pybullet's arguments for a shape without triangles."""
    if isinstance(geometry, Box):
        return {"shapeType": pybullet.GEOM_BOX, "halfExtents": [size / 2 for size in geometry.size]}
    if isinstance(geometry, Cylinder):
        return {"shapeType": pybullet.GEOM_CYLINDER, "radius": geometry.radius, "height": geometry.length}
    if isinstance(geometry, Sphere):
        return {"shapeType": pybullet.GEOM_SPHERE, "radius": geometry.radius}
    return {"shapeType": pybullet.GEOM_PLANE, "planeNormal": geometry.normal}


def _meshes(corners: np.ndarray) -> Iterator[Dict[str, Any]]:
    """pybullet's arguments for triangles (n, 3, 3) [m], in pieces of at most MAX_TRIANGLES."""
    for start in range(0, len(corners), MAX_TRIANGLES):
        vertices = corners[start : start + MAX_TRIANGLES].reshape(-1, 3)
        yield {
            "shapeType": pybullet.GEOM_MESH,
            "vertices": vertices.tolist(),
            "indices": list(range(len(vertices))),
        }


def _both_sides(corners: np.ndarray) -> np.ndarray:
    """Triangles (2 n, 3, 3) that are visible from both sides, made of (n, 3, 3) that are visible from one side only."""
    return np.stack([corners, corners[:, ::-1]], axis=1).reshape(-1, 3, 3)


def _surface_triangles(surface: Union[Mesh, Walls]) -> np.ndarray:
    """The triangles (n, 3, 3) [m] of a mesh or of walls, two for each wall.

    Walls are one mesh, because Bullet visits every body at every step but finds a mesh's triangles by an index.
    """
    if isinstance(surface, Mesh):
        return surface.corners
    low = np.concatenate([surface.segments, np.zeros((len(surface.segments), 2, 1))], axis=-1)
    high = low + [0.0, 0.0, surface.height]
    (a, b), (c, d) = low.swapaxes(0, 1), high.swapaxes(0, 1)
    return np.stack([np.stack([a, b, c], axis=1), np.stack([b, d, c], axis=1)], axis=1).reshape(-1, 3, 3)


def _cylinder_triangles(cylinder: Cylinder) -> np.ndarray:
    """Triangles (n, 3, 3) [m], visible from outside. Bullet's own visual cylinder is too coarse: up to 2 cm off."""
    turns = 2.0 * np.pi * np.arange(SIDES + 1) / SIDES
    ring = np.column_stack([cylinder.radius * np.cos(turns), cylinder.radius * np.sin(turns), np.zeros(SIDES + 1)])
    up = np.array([0.0, 0.0, cylinder.length / 2.0])
    low, high = ring - up, ring + up
    a, b, c, d = low[:-1], low[1:], high[:-1], high[1:]
    middle = np.zeros_like(a)
    return np.concatenate(
        [np.stack(part, axis=1) for part in ((a, b, d), (a, d, c), (c, d, middle + up), (b, a, middle - up))]
    )


def _plane_triangles(normal: np.ndarray) -> np.ndarray:
    """Two triangles (2, 3, 3) [m] around the origin that show a plane."""
    aside = np.cross(normal, [1.0, 0.0, 0.0] if abs(normal[0]) < 0.9 else [0.0, 1.0, 0.0])
    aside *= HALF_PLANE / np.linalg.norm(aside)
    along = np.cross(normal, aside)
    a, b, c, d = aside + along, along - aside, -aside - along, aside - along
    return np.array([[a, b, c], [a, c, d]])
