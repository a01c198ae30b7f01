"""The ground of a world: the level on which robots stand, which may be the top of a slab instead of z = 0.

Gazebo's asphalt_plane and grass_plane, for instance, are boxes of 20 x 20 x 0.1 m whose top is at z = 0.05 m.
"""

import math
from dataclasses import replace
from typing import NamedTuple, Optional

import numpy as np

from ..geometry import Pose2D, Pose3D, compose, inverse, rotation_matrix
from ..shapes import Box, Cylinder, Mesh, Plane, Sphere
from .model import Obstacle, World

MAX_TOP = 0.2  # [m] above z = 0: the highest top of a slab that is ground
MIN_SIDE = 3.0  # [m] the shortest side of a slab that is ground
MAX_TILT = 1e-3  # [rad] that a slab may be tilted; then its highest point is the ground
LEVEL = 1e-6  # [m] by which a top may be higher than the ground and still be part of it
MAX_TILT_OF_PLANE = 1e-6  # [rad] of a plane, which has no end, that is level
MIN_FILLED = 0.9  # of its rectangle: what the top of a mesh has to cover to be a slab


class _Slab(NamedTuple):
    """A slab or level plane that robots can stand on.

    top: its height [m]; world_from_slab: the pose of its centre; length, width [m]: its sides along that pose's x and y
    """

    top: float
    world_from_slab: Pose2D
    length: float
    width: float

    def covers(self, x: float, y: float) -> bool:
        """Return whether the slab is below a point [m]."""
        point = compose(inverse(self.world_from_slab), Pose2D(x, y))
        return abs(point.x) <= self.length / 2.0 and abs(point.y) <= self.width / 2.0


def top(obstacle: Obstacle) -> float:
    """The height [m] of an obstacle's highest point; +inf for a plane, unless it is level and faces up."""
    shape, z, turn = obstacle.geometry, obstacle.pose.position[2], rotation_matrix(obstacle.pose.orientation)
    if isinstance(shape, Plane):
        return z if float(turn[2] @ np.array(shape.normal)) >= math.cos(MAX_TILT_OF_PLANE) else math.inf
    if isinstance(shape, Mesh):
        return z + float((shape.corners @ turn[2]).max())
    if isinstance(shape, Box):
        return z + float(np.abs(turn[2]) @ np.array(shape.size)) / 2.0
    if isinstance(shape, Cylinder):
        upwards = min(abs(float(turn[2, 2])), 1.0)
        return z + upwards * shape.length / 2.0 + math.sqrt(1.0 - upwards**2) * shape.radius
    if isinstance(shape, Sphere):
        return z + shape.radius
    return z + shape.height


def is_in_ground(obstacle: Obstacle) -> bool:
    """Return whether an obstacle of a levelled world is ground or below it, so that robots never touch its sides."""
    return top(obstacle) <= LEVEL


def levelled(world: World) -> World:
    """A world moved up or down, so that the ground on which its robots stand is at z = 0.

    The ground is large, level and low: the highest of the slabs and level planes where robots start, or, if there is
    none, the largest slab of the world. It is never below the z = 0 of the world's file,
    where the simulator has a floor of its own. Slabs that are higher than the ground are obstacles.
    """
    slabs = [slab for slab in map(_slab, world.obstacles) if slab is not None and slab.top + world.ground <= MAX_TOP]
    below = [slab for slab in slabs if slab.covers(world.spawn.x, world.spawn.y)]
    found = below or sorted(slabs, key=lambda slab: slab.length * slab.width)[-1:]
    ground = max([0.0, *(slab.top + world.ground for slab in found)])
    if abs(ground - world.ground) <= LEVEL:
        return world

    def raised(pose: Pose3D) -> Pose3D:
        x, y, z = pose.position
        return Pose3D((x, y, z + world.ground - ground), pose.orientation)

    return replace(
        world,
        obstacles=tuple(replace(obstacle, pose=raised(obstacle.pose)) for obstacle in world.obstacles),
        models={name: raised(pose) for name, pose in world.models.items()},
        ground=ground,
    )


def _slab(obstacle: Obstacle) -> Optional[_Slab]:
    """The slab or level plane that an obstacle is, or None if robots could not stand on it."""
    shape, height = obstacle.geometry, top(obstacle)
    if isinstance(shape, Plane):
        return _Slab(height, Pose2D(), math.inf, math.inf) if math.isfinite(height) else None
    if isinstance(shape, Mesh):
        return _slab_of_mesh(obstacle.pose, shape, height)
    if not isinstance(shape, (Box, Cylinder)) or obstacle.motion is not None:
        return None
    if abs(float(rotation_matrix(obstacle.pose.orientation)[2, 2])) < math.cos(MAX_TILT):  # near -1: it is turned over
        return None
    length, width = shape.size[:2] if isinstance(shape, Box) else (2.0 * shape.radius,) * 2
    return _Slab(height, obstacle.pose.on_plane(), length, width) if min(length, width) >= MIN_SIDE else None


def _slab_of_mesh(pose: Pose3D, mesh: Mesh, height: float) -> Optional[_Slab]:
    """A mesh whose level top fills its rectangle along its x and y axes, or along the world's if it is not upright."""
    axes = pose.on_plane() if pose.is_upright() else Pose2D(*pose.position[:2])
    corners = mesh.corners if pose.is_upright() else mesh.corners @ rotation_matrix(pose.orientation).T
    low, high = corners[..., :2].min(axis=(0, 1)), corners[..., :2].max(axis=(0, 1))
    length, width = (high - low).tolist()
    if min(length, width) < MIN_SIDE:
        return None
    lid = corners[(corners[..., 2] + pose.position[2] >= height - LEVEL).all(axis=1)][..., :2]
    (ax, ay), (bx, by) = (lid[:, 1] - lid[:, 0]).T, (lid[:, 2] - lid[:, 0]).T
    if np.abs(ax * by - ay * bx).sum() / 2.0 < MIN_FILLED * length * width:
        return None
    x, y = ((low + high) / 2.0).tolist()
    return _Slab(height, compose(axes, Pose2D(x, y)), length, width)
