"""The image geometry of an RGB-D camera: a pinhole camera without distortion, pixel centres at integer coordinates.

Images have shape (height, width), row 0 at the top; the optical frame has z forward, x right, y down (REP-103).
"""

import math
from dataclasses import dataclass
from typing import Dict, List, Optional, Tuple

import numpy as np

from ..param_loading import PROFILES_OWN, parameter, positive

Figures = Tuple[int, int, float]  # width, height [pixels], horizontal field of view [rad]

SMALL: Figures = (160, 120, 1.02974)  # the field of view in turtlebot3_description's URDF; small images cost less
# By the models' names in their URDF. Figures of the camera plug-ins in turtlebot3_gazebo (noetic).
PROFILES: Dict[str, Dict[str, Figures]] = {
    "small": {},
    "gazebo": {"turtlebot3_waffle": (1920, 1080, 1.3439), "turtlebot3_waffle_pi": (640, 480, 1.0856)},
}
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


@dataclass(frozen=True)
class CameraParams:
    """The cameras: a profile, figures that replace its own, and how often they take images."""

    camera_profile: str = parameter("small", choices=tuple(PROFILES))
    camera_width: Optional[int] = parameter(None, low=1, high=4096, otherwise=PROFILES_OWN)
    camera_height: Optional[int] = parameter(None, low=1, high=4096, otherwise=PROFILES_OWN)
    camera_angle: Optional[float] = parameter(None, low=0.01, high=3.0, otherwise=PROFILES_OWN)  # [rad]
    camera_range_min: float = positive(0.05)  # [m]
    camera_range_max: float = positive(10.0)  # [m]
    camera_rate: int = parameter(10, low=0)  # [Hz]; 0: never

    def spec(self, model: str) -> CameraSpec:
        """The camera of a model, by its name."""
        width, height, angle = PROFILES[self.camera_profile].get(model, SMALL)
        return CameraSpec(
            width if self.camera_width is None else self.camera_width,
            height if self.camera_height is None else self.camera_height,
            angle if self.camera_angle is None else self.camera_angle,
            self.camera_range_min,
            self.camera_range_max,
        )


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
