"""The cross-section of a world at one height, as line segments and circles."""

import math
from typing import Optional, Sequence, Tuple

import numpy as np

from ..geometry import Pose3D, Vector3, rotation_matrix
from ..shapes import Box, Cylinder, Geometry, Mesh, PlacedShape, Plane, Sphere, Walls
from ..world.model import World
from ..world.scripted_motion import Motion, moving
from .tiles import Tiles

CYLINDER_SIDES = 64  # of the prism that approximates a tilted cylinder; upright cylinders are exact
FAR = 1e4  # [m] half the length of the segment that represents a vertical plane
LEVEL = 1e-9  # horizontal part of a unit normal below which a plane counts as level
MIN_INDEXED = 1000  # segments; above this number an index is worth its cost (measured)

NO_SEGMENTS, NO_CIRCLES = np.zeros((0, 2, 2)), np.zeros((0, 3))


class CrossSection:
    """Segments and circles in the horizontal plane at one height, in the world frame.

    Only circles move: moving obstacles are upright cylinders or spheres. Until `move`, they are where they are at
    time zero.
    """

    def __init__(self, world: World, height: float) -> None:
        outlines = [outline(obstacle, height) for obstacle in world.obstacles]
        motions = [obstacle.motion for obstacle, (_, circles) in zip(world.obstacles, outlines) for _ in circles]
        self.segments = np.concatenate([NO_SEGMENTS, *(of_one for of_one, _ in outlines)])  # (m, [start, end], [x, y])
        self.circles = np.concatenate([NO_CIRCLES, *(of_one for _, of_one in outlines)])  # (k, [x, y, radius]) [m]
        self.circles_at_start = self.circles.copy()
        self.motions: Sequence[Optional[Motion]] = motions  # of each circle; None: it never moves
        self.tiles = Tiles(self.segments) if len(self.segments) > MIN_INDEXED else None
        self.move = moving(self.circles, motions)  # to be called with a time [s]


def outline(placed: PlacedShape, height: float) -> Tuple[np.ndarray, np.ndarray]:
    """Where the horizontal plane at a height [m] cuts a shape: segments (m, 2, 2) and circles (0 or 1, 3) [m].

    Spheres and upright cylinders are circles, everything else is segments. Both are empty above or below the shape.
    """
    geometry, pose = placed.geometry, placed.pose
    x, y, z = pose.position
    if isinstance(geometry, Sphere):
        squared = geometry.radius**2 - (height - z) ** 2
        return NO_SEGMENTS, np.array([(x, y, math.sqrt(squared))]) if squared > 0.0 else NO_CIRCLES
    if isinstance(geometry, Cylinder) and pose.is_upright():
        is_cut = abs(height - z) < geometry.length / 2.0
        return NO_SEGMENTS, np.array([(x, y, geometry.radius)]) if is_cut else NO_CIRCLES
    return _segments(geometry, pose, height), NO_CIRCLES


def _segments(geometry: Geometry, pose: Pose3D, height: float) -> np.ndarray:
    if isinstance(geometry, Mesh):
        return _mesh_segments(pose, geometry, height)
    if isinstance(geometry, Walls):
        return _wall_segments(pose, geometry, height)
    if isinstance(geometry, Plane):
        return _plane_line(pose, geometry, height)
    if isinstance(geometry, Box):
        base, size = np.array([(0.5, 0.5), (-0.5, 0.5), (-0.5, -0.5), (0.5, -0.5)]), geometry.size
    elif isinstance(geometry, Cylinder):
        turns = 2.0 * math.pi * np.arange(CYLINDER_SIDES) / CYLINDER_SIDES
        base = np.stack([np.cos(turns), np.sin(turns)], axis=1)
        size = (geometry.radius, geometry.radius, geometry.length)
    else:
        raise TypeError(f"no outline for {geometry!r}")
    return _prism_outline(base, size, pose, height)


def _prism_outline(base: np.ndarray, size: Vector3, pose: Pose3D, height: float) -> np.ndarray:
    """The intersection of a prism with a horizontal plane: its edges' crossings, sorted by direction.

    base: the corners (n, [x, y]) of a prism of height 1 centred on the origin, which `size` scales
    """
    n = len(base)
    corners = np.column_stack([np.concatenate([base, base]), np.repeat([-0.5, 0.5], n)])
    corners = (corners * np.array(size)) @ rotation_matrix(pose.orientation).T + np.array(pose.position)
    corners[:, 2] -= height
    low, high = corners[:n], corners[n:]
    starts = np.concatenate([low, low, high])
    ends = np.concatenate([high, np.roll(low, -1, axis=0), np.roll(high, -1, axis=0)])
    cut = starts[:, 2] * ends[:, 2] < 0.0
    starts, ends = starts[cut], ends[cut]
    if len(starts) < 3:
        return NO_SEGMENTS
    points = (starts + (ends - starts) * (starts[:, 2:] / (starts[:, 2:] - ends[:, 2:])))[:, :2]
    around = points - points.mean(axis=0)
    points = points[np.argsort(np.arctan2(around[:, 1], around[:, 0]))]
    return np.stack([points, np.roll(points, -1, axis=0)], axis=1)


def _mesh_segments(pose: Pose3D, mesh: Mesh, height: float) -> np.ndarray:
    """The intersection of a mesh's triangles with a horizontal plane: segments (m, 2, 2)."""
    import trimesh  # takes 0.3 s, and most worlds have no meshes

    corners = mesh.corners @ rotation_matrix(pose.orientation).T + np.array(pose.position)
    faces = np.arange(3 * len(corners)).reshape(-1, 3)
    placed = trimesh.Trimesh(corners.reshape(-1, 3), faces, process=False)
    lines: np.ndarray = trimesh.intersections.mesh_plane(placed, (0.0, 0.0, 1.0), (0.0, 0.0, height))
    return lines[..., :2]


def _wall_segments(pose: Pose3D, walls: Walls, height: float) -> np.ndarray:
    """The walls' own segments; none where the height is above or below the walls."""
    if not 0.0 <= height - pose.position[2] < walls.height:
        return NO_SEGMENTS
    return walls.segments @ rotation_matrix(pose.orientation)[:2, :2].T + np.array(pose.position[:2])


def _plane_line(pose: Pose3D, plane: Plane, height: float) -> np.ndarray:
    """The line where an infinite plane crosses the horizontal plane at a height [m]; empty for a level plane."""
    nx, ny, nz = (float(v) for v in rotation_matrix(pose.orientation) @ np.array(plane.normal))
    flat = math.hypot(nx, ny)
    if flat < LEVEL:
        return NO_SEGMENTS
    x, y, z = pose.position
    offset = -nz * (height - z) / flat
    ux, uy = nx / flat, ny / flat
    px, py = x + ux * offset, y + uy * offset
    return np.array([[(px - uy * FAR, py + ux * FAR), (px + uy * FAR, py - ux * FAR)]])
