"""The image geometry of an RGB-D camera: a pinhole camera without distortion, pixel centres at integer coordinates.

Images have shape (height, width), row 0 at the top; the optical frame has z forward, x right, y down (REP-103).
"""

import math
from dataclasses import dataclass
from typing import List

import numpy as np

ROUNDING = 1e-3  # relative error of a single-precision depth buffer near the farthest depth


@dataclass(frozen=True)
class CameraSpec:
    """Image size [pixels], horizontal field of view [rad], nearest and farthest depth [m]."""

    width: int
    height: int
    angle: float
    near: float
    far: float

    @property
    def focal(self) -> float:
        """Focal length [pixels], the same in both directions."""
        return self.width / 2.0 / math.tan(self.angle / 2.0)

    @property
    def centre_x(self) -> float:
        """Column [pixels] of the optical axis."""
        return (self.width - 1) / 2.0

    @property
    def centre_y(self) -> float:
        """Row [pixels] of the optical axis."""
        return (self.height - 1) / 2.0


@dataclass(frozen=True, eq=False)
class CameraImage:
    """rgb (height, width, 3) uint8; depth (height, width) float32 [m] along the optical frame's z, +inf = no return."""

    rgb: np.ndarray
    depth: np.ndarray


def projection(spec: CameraSpec) -> List[float]:
    """OpenGL's projection matrix, column-major, for a renderer that samples at integer pixels from the lower left."""
    deep = spec.far - spec.near
    matrix = np.array(
        [
            [2.0 * spec.focal / spec.width, 0.0, 1.0 / spec.width, 0.0],
            [0.0, 2.0 * spec.focal / spec.height, 1.0 / spec.height, 0.0],
            [0.0, 0.0, -(spec.far + spec.near) / deep, -2.0 * spec.far * spec.near / deep],
            [0.0, 0.0, -1.0, 0.0],
        ]
    )
    return [float(value) for value in matrix.T.ravel()]


def depth_of(buffer: np.ndarray, spec: CameraSpec) -> np.ndarray:
    """Depth (height, width) float32 [m] from an OpenGL depth buffer with values from 0 to 1; the background is +inf."""
    depth = spec.far * spec.near / (spec.far - (spec.far - spec.near) * buffer.astype(np.float64))
    return np.where(depth < spec.far * (1.0 - ROUNDING), depth, np.inf).astype(np.float32)


def points_of(depth: np.ndarray, spec: CameraSpec) -> np.ndarray:
    """Points (height, width, 3) float32 [m] in the optical frame; NaN where there is no return."""
    z = np.where(np.isfinite(depth), depth, np.nan)
    columns, rows = np.arange(spec.width), np.arange(spec.height)[:, None]
    x, y = z * (columns - spec.centre_x) / spec.focal, z * (rows - spec.centre_y) / spec.focal
    return np.stack([x, y, z], axis=-1).astype(np.float32)
