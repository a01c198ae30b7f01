"""The geometry of an RGB-D camera's images: a pinhole without distortion, pixels' centres at whole numbers.

Images have shape (height, width), row 0 at the top; the optical frame has z ahead, x to the right, y down (REP-103).
"""

import math
from dataclasses import dataclass
from typing import List

import numpy as np

ROUNDING = 1e-3  # share of the farthest depth within which a depth buffer of single precision may miss it


@dataclass(frozen=True)
class CameraSpec:
    """Image size [pixels], horizontal angle of view [rad], nearest and farthest depth [m]."""

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
    """rgb (height, width, 3) uint8; depth (height, width) float32 [m] along z of the optical frame, +inf = too far."""

    rgb: np.ndarray
    depth: np.ndarray


def projection(spec: CameraSpec) -> List[float]:
    """OpenGL's projection matrix, column by column, for a renderer that samples at whole pixels from the lower left."""
    x, y = 2.0 * spec.focal / spec.width, 2.0 * spec.focal / spec.height
    deep = spec.far - spec.near
    return [x, 0.0, 0.0, 0.0,
            0.0, y, 0.0, 0.0,
            1.0 / spec.width, 1.0 / spec.height, -(spec.far + spec.near) / deep, -1.0,
            0.0, 0.0, -2.0 * spec.far * spec.near / deep, 0.0]


def depth_of(buffer: np.ndarray, spec: CameraSpec) -> np.ndarray:
    """Depth (height, width) float32 [m] from OpenGL's depth buffer of values 0 to 1; the background is +inf."""
    depth = spec.far * spec.near / (spec.far - (spec.far - spec.near) * buffer.astype(np.float64))
    return np.where(depth < spec.far * (1.0 - ROUNDING), depth, np.inf).astype(np.float32)


def points_of(depth: np.ndarray, spec: CameraSpec) -> np.ndarray:
    """Points (height, width, 3) float32 [m] in the optical frame; NaN where nothing is in reach."""
    z = np.where(np.isfinite(depth), depth, np.nan)
    columns, rows = np.arange(spec.width), np.arange(spec.height)[:, None]
    x, y = z * (columns - spec.centre_x) / spec.focal, z * (rows - spec.centre_y) / spec.focal
    return np.stack([x, y, z], axis=-1).astype(np.float32)
