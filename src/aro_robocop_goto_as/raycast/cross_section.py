"""The cross-section of a world at one height, as line segments and circles."""

import copy
import math
from typing import List, Optional, Tuple

import numpy as np

from ..geometry import Pose2D, Pose3D, rotation_matrix
from ..world.model import Box, Cylinder, Mesh, Obstacle, Plane, Sphere, Walls, World
from ..world.scripted_motion import Motion
from .grid_index import Tiles

CYLINDER_SIDES = 64  # of the prism that approximates a tilted cylinder; upright cylinders are exact
FAR = 1e4  # [m] half the length of the segment that represents a vertical plane
UPRIGHT = 1e-9  # x and y of a unit vector or quaternion below which it counts as vertical
FEW = 1000  # segments; above this number an index is worth its cost (measured)

Segment = Tuple[Tuple[float, float], Tuple[float, float]]
Circle = Tuple[float, float, float]  # x, y, radius [m]


class Slice:
    """Segments and circles in the horizontal plane at one height, in the world frame; moving circles at time zero."""

    def __init__(self, world: World, height: float) -> None:
        segments: List[Segment] = []
        circles: List[Circle] = []
        segment_arrays: List[np.ndarray] = []
        self._moving: List[Tuple[int, Motion, Pose2D]] = []  # row in circles, its motion, its centre at time zero
        for obstacle in world.obstacles:
            circle = _circle(obstacle, height)
            if circle is not None:
                if obstacle.motion is not None:
                    self._moving.append((len(circles), obstacle.motion, Pose2D(*circle[:2])))
                circles.append(circle)
            elif isinstance(obstacle.geometry, Mesh):
                segment_arrays.append(_mesh_segments(obstacle.pose, obstacle.geometry, height))
            elif isinstance(obstacle.geometry, Walls):
                segment_arrays.append(_wall_segments(obstacle.pose, obstacle.geometry, height))
            else:
                segments += _segments(obstacle, height)
        outlines = np.array(segments, dtype=float).reshape(-1, 2, 2)
        self.segments = np.concatenate([outlines, *segment_arrays])  # (m, [start, end], [x, y]) [m]
        self.circles = np.array(circles, dtype=float).reshape(-1, 3)  # (k, [x, y, radius]) [m]
        self.tiles = Tiles(self.segments) if len(self.segments) > FEW else None

    def at(self, time: float) -> "Slice":
        """The cross-section at a time [s]. Only circles move: moving obstacles are upright cylinders or spheres."""
        if not self._moving:
            return self
        moved = copy.copy(self)
        moved.circles = self.circles.copy()
        moved.move(time)
        return moved

    def move(self, time: float) -> None:
        """Set the moving circles to where they are at a time [s], in place."""
        for row, motion, start in self._moving:
            pose = motion.carry(start, time)
            self.circles[row, :2] = pose.x, pose.y


def _circle(obstacle: Obstacle, height: float) -> Optional[Circle]:
    """The circle of a sphere or an upright cylinder; None for other shapes, and above or below the obstacle."""
    x, y, z = obstacle.pose.position
    geometry = obstacle.geometry
    if isinstance(geometry, Sphere):
        squared = geometry.radius**2 - (height - z) ** 2
        return (x, y, math.sqrt(squared)) if squared > 0.0 else None
    if isinstance(geometry, Cylinder) and _upright(obstacle.pose):
        return (x, y, geometry.radius) if abs(height - z) < geometry.length / 2.0 else None
    return None


def _upright(pose: Pose3D) -> bool:
    qx, qy, _, _ = pose.orientation
    return abs(qx) < UPRIGHT and abs(qy) < UPRIGHT


def _segments(obstacle: Obstacle, height: float) -> List[Segment]:
    """The outline of a plane, a box or a tilted cylinder at a height [m]."""
    geometry = obstacle.geometry
    if isinstance(geometry, Plane):
        return _plane_line(obstacle, geometry, height)
    if isinstance(geometry, Box):
        corners, edges = _prism([(0.5, 0.5), (-0.5, 0.5), (-0.5, -0.5), (0.5, -0.5)])
        scale = np.array(geometry.size)
    elif isinstance(geometry, Cylinder) and not _upright(obstacle.pose):
        turns = 2.0 * math.pi * np.arange(CYLINDER_SIDES) / CYLINDER_SIDES
        corners, edges = _prism(list(zip(np.cos(turns), np.sin(turns))))
        scale = np.array([geometry.radius, geometry.radius, geometry.length])
    else:
        return []
    world_corners = (corners * scale) @ rotation_matrix(obstacle.pose.orientation).T + np.array(obstacle.pose.position)
    return _outline(world_corners, edges, height)


def _prism(base: List[Tuple[float, float]]) -> Tuple[np.ndarray, List[Tuple[int, int]]]:
    """Corners (2 n, 3) and edges of a prism of height 1 whose base is a polygon with n corners."""
    n = len(base)
    corners = np.array([(x, y, -0.5) for x, y in base] + [(x, y, 0.5) for x, y in base])
    edges = [(i, i + n) for i in range(n)]
    for level in (0, n):
        edges += [(level + i, level + (i + 1) % n) for i in range(n)]
    return corners, edges


def _outline(corners: np.ndarray, edges: List[Tuple[int, int]], height: float) -> List[Segment]:
    """The intersection of a convex body with a horizontal plane: its edges' crossings, sorted by direction."""
    crossings = []
    for a, b in edges:
        low, high = corners[a][2] - height, corners[b][2] - height
        if low * high < 0.0:
            crossings.append(corners[a][:2] + (corners[b][:2] - corners[a][:2]) * (low / (low - high)))
    if len(crossings) < 3:
        return []
    points = np.array(crossings)
    around = points - points.mean(axis=0)
    points = points[np.argsort(np.arctan2(around[:, 1], around[:, 0]))]
    ring = [(float(x), float(y)) for x, y in points]
    return list(zip(ring, ring[1:] + ring[:1]))


def _mesh_segments(pose: Pose3D, mesh: Mesh, height: float) -> np.ndarray:
    """The exact intersection of a mesh's triangles with a horizontal plane: segments (m, 2, 2).

    A corner exactly at the height counts as below it, so that triangles which share an edge there are treated alike.
    """
    corners = mesh.corners @ rotation_matrix(pose.orientation).T + np.array(pose.position)
    above = corners[..., 2] > height
    cut = above.any(axis=1) & ~above.all(axis=1)
    corners, above = corners[cut], above[cut]
    # The tip is the one corner on its side of the plane; both of its edges cross the plane.
    tip_index = np.argmax(np.where(above.sum(axis=1, keepdims=True) == 1, above, ~above), axis=1)
    rows = np.arange(len(corners))
    tip, left, right = (corners[rows, (tip_index + turn) % 3] for turn in range(3))
    ends = [tip + (foot - tip) * ((height - tip[:, 2]) / (foot[:, 2] - tip[:, 2]))[:, None] for foot in (left, right)]
    segments = np.stack(ends, axis=1)[..., :2]
    return segments[(segments[:, 0] != segments[:, 1]).any(axis=1)]


def _wall_segments(pose: Pose3D, walls: Walls, height: float) -> np.ndarray:
    """The walls' own segments; none where the height is above or below the walls."""
    if not 0.0 <= height - pose.position[2] < walls.height:
        return np.zeros((0, 2, 2))
    return walls.segments @ rotation_matrix(pose.orientation)[:2, :2].T + np.array(pose.position[:2])


def _plane_line(obstacle: Obstacle, plane: Plane, height: float) -> List[Segment]:
    """The line where an infinite plane crosses the horizontal plane at a height [m]; empty for a level plane."""
    nx, ny, nz = (float(v) for v in rotation_matrix(obstacle.pose.orientation) @ np.array(plane.normal))
    flat = math.hypot(nx, ny)
    if flat < UPRIGHT:
        return []
    x, y, z = obstacle.pose.position
    offset = -nz * (height - z) / flat
    ux, uy = nx / flat, ny / flat
    px, py = x + ux * offset, y + uy * offset
    return [((px - uy * FAR, py + ux * FAR), (px + uy * FAR, py - ux * FAR))]
