"""Create Bullet's collision shapes, visual shapes and bodies for geometries and robots."""

import os
import tempfile
from typing import Any, Dict, List

import numpy as np

from ..errors import RobotModelError
from ..geometry import Pose3D
from ..robot.model import RobotModel
from ..world.model import Box, Cylinder, Geometry, Mesh, Obstacle, Plane, Sphere, Walls
from .quiet_pybullet import pybullet

FLOOR = Obstacle("floor", Pose3D(), Plane((0.0, 0.0, 1.0)))
MAX_TRIANGLES = 30000  # per shape; pybullet refuses more than 131,072 vertices
GROUND = (0.55, 0.55, 0.52, 1.0)  # colour of planes, RGBA
SOLID = (0.62, 0.70, 0.80, 1.0)  # colour of everything else, as in RViz
SIDES = 64  # of the prism that shows a cylinder
HALF_PLANE = 100.0  # [m] half the side of the square that shows a plane


def load_urdf(model: RobotModel, client: int) -> int:
    """Create a robot's body at the origin; RobotModelError if Bullet refuses it."""
    with tempfile.TemporaryDirectory(prefix="robocop_") as folder:
        path = os.path.join(folder, model.name + ".urdf")
        with open(path, "w") as stream:
            stream.write(model.physics_urdf)
        try:
            return int(pybullet.loadURDF(path, flags=pybullet.URDF_USE_INERTIA_FROM_FILE, physicsClientId=client))
        except pybullet.error as error:
            raise RobotModelError(f"{model.name}: Bullet refused the robot: {error}") from error


def visual_shapes(geometry: Geometry, client: int) -> List[int]:
    """Create the visual shapes of a geometry; planes, meshes and walls are visible from both sides."""
    if isinstance(geometry, Mesh):
        return _visual_meshes(geometry.corners, SOLID, client)
    if isinstance(geometry, Walls):
        return _visual_meshes(_wall_triangles(geometry), SOLID, client)
    if isinstance(geometry, Plane):
        return _visual_meshes(_plane_triangles(np.array(geometry.normal)), GROUND, client)
    if isinstance(geometry, Cylinder):
        return _visual_meshes(_cylinder_triangles(geometry), SOLID, client, both_sides=False)
    shape: Dict[str, Any]
    if isinstance(geometry, Box):
        shape = {"shapeType": pybullet.GEOM_BOX, "halfExtents": [size / 2 for size in geometry.size]}
    else:
        shape = {"shapeType": pybullet.GEOM_SPHERE, "radius": geometry.radius}
    return [int(pybullet.createVisualShape(rgbaColor=SOLID, physicsClientId=client, **shape))]


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


def _visual_meshes(corners: np.ndarray, color: Any, client: int, both_sides: bool = True) -> List[int]:
    """Visual shapes of triangles (n, 3, 3) [m], visible from where they run counter-clockwise, or from both sides."""
    if both_sides:
        corners = np.stack([corners, corners[:, ::-1]], axis=1).reshape(-1, 3, 3)
    shapes = []
    for start in range(0, len(corners), MAX_TRIANGLES):
        piece = corners[start : start + MAX_TRIANGLES]
        edges = np.cross(piece[:, 1] - piece[:, 0], piece[:, 2] - piece[:, 0])
        normals = edges / np.maximum(np.linalg.norm(edges, axis=1, keepdims=True), 1e-30)
        shapes.append(
            int(
                pybullet.createVisualShape(
                    pybullet.GEOM_MESH,
                    vertices=piece.reshape(-1, 3).tolist(),
                    indices=list(range(3 * len(piece))),
                    normals=np.repeat(normals, 3, axis=0).tolist(),
                    rgbaColor=color,
                    physicsClientId=client,
                )
            )
        )
    return shapes


def shapes_of(geometry: Geometry, client: int) -> List[int]:
    """Create the collision shapes of a static body; more than one only above MAX_TRIANGLES."""
    if isinstance(geometry, Mesh):
        return _mesh_shapes(geometry.corners, client)
    if isinstance(geometry, Walls):
        return _mesh_shapes(_wall_triangles(geometry), client)
    return [_primitive_shape(geometry, client)]


def _wall_triangles(walls: Walls) -> np.ndarray:
    """Two triangles for each of n walls, (2 n, 3, 3) [m].

    As one mesh, because Bullet visits every body at every step but finds a mesh's triangles by an index.
    """
    low = np.concatenate([walls.segments, np.zeros((len(walls.segments), 2, 1))], axis=-1)
    high = low + [0.0, 0.0, walls.height]
    (a, b), (c, d) = low.swapaxes(0, 1), high.swapaxes(0, 1)
    return np.stack([np.stack([a, b, c], axis=1), np.stack([b, d, c], axis=1)], axis=1).reshape(-1, 3, 3)


def _mesh_shapes(corners: np.ndarray, client: int) -> List[int]:
    pieces = range(0, len(corners), MAX_TRIANGLES)
    return [_mesh_shape(corners[start : start + MAX_TRIANGLES], client) for start in pieces]


def _primitive_shape(geometry: Geometry, client: int) -> int:
    if isinstance(geometry, Box):
        return int(
            pybullet.createCollisionShape(
                pybullet.GEOM_BOX, halfExtents=[size / 2 for size in geometry.size], physicsClientId=client
            )
        )
    if isinstance(geometry, Cylinder):
        return int(
            pybullet.createCollisionShape(
                pybullet.GEOM_CYLINDER, radius=geometry.radius, height=geometry.length, physicsClientId=client
            )
        )
    if isinstance(geometry, Sphere):
        return int(pybullet.createCollisionShape(pybullet.GEOM_SPHERE, radius=geometry.radius, physicsClientId=client))
    if isinstance(geometry, Plane):
        return int(
            pybullet.createCollisionShape(pybullet.GEOM_PLANE, planeNormal=geometry.normal, physicsClientId=client)
        )
    raise TypeError(f"no shape for {geometry!r}")


def _mesh_shape(corners: np.ndarray, client: int) -> int:
    """A collision shape of triangles (n, 3, 3) [m], hollow instead of their convex hull."""
    return int(
        pybullet.createCollisionShape(
            pybullet.GEOM_MESH,
            vertices=corners.reshape(-1, 3).tolist(),
            indices=list(range(3 * len(corners))),
            flags=pybullet.GEOM_FORCE_CONCAVE_TRIMESH,
            physicsClientId=client,
        )
    )
