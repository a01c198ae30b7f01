"""The shapes of which worlds and robots are made."""

from dataclasses import dataclass
from typing import Union

import numpy as np

from .geometry import Pose3D, Vector3


@dataclass(frozen=True)
class Box:
    """A cuboid centred on the shape's origin; size: its lengths [m] along the shape's x, y, z."""

    size: Vector3


@dataclass(frozen=True)
class Cylinder:
    """A cylinder centred on the shape's origin, its axis along the shape's z; radius, length [m]."""

    radius: float
    length: float


@dataclass(frozen=True)
class Sphere:
    """A sphere centred on the shape's origin; radius [m]."""

    radius: float


@dataclass(frozen=True)
class Plane:
    """An infinite plane through the shape's origin; normal: unit vector in the shape's frame."""

    normal: Vector3


@dataclass(frozen=True, eq=False)
class Mesh:
    """Triangles, solid from both sides; corners: (n, 3, 3) [m] in the shape's frame; file: where they were read."""

    corners: np.ndarray
    file: str


@dataclass(frozen=True, eq=False)
class Walls:
    """Vertical walls without thickness, solid from both sides, such as the outlines of a map's occupied cells.

    segments: (n, [start, end], [x, y]) [m] in the shape's frame; the walls reach from its z = 0 to height [m]
    """

    segments: np.ndarray
    height: float


Geometry = Union[Box, Cylinder, Sphere, Plane, Mesh, Walls]


@dataclass(frozen=True)
class PlacedShape:
    """A shape with a name, at the pose [m] of its centre (for a Plane: of a point on it)."""

    name: str
    pose: Pose3D
    geometry: Geometry
