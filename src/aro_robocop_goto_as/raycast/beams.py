"""Exact distances along a fan of evenly spaced beams, for any number of scanners at once."""

import ctypes
import math
from typing import Sequence

import numpy as np

from ..compiled import address
from .caster_library import FanStruct
from .cross_section import CrossSection
from .scene import ScanPlane, Scene

TOLERANCE = 1e-9  # [rad] as in caster.c
REFUSED = {1: "robots: expected numbers of robots in the scene", 2: "poses: expected finite numbers"}  # as in caster.c


class Fan:
    """Beams at angle_min + i * increment [rad], i from 0 to samples - 1, counter-clockwise in the scanner's frame."""

    def __init__(self, angle_min: float, increment: float, samples: int) -> None:
        if not (increment > 0.0 and samples >= 1):
            raise ValueError(f"expected increment > 0 and samples >= 1, got {increment} and {samples}")
        if not (math.isfinite(angle_min) and math.isfinite(increment * samples)):
            raise ValueError(f"expected finite angles, got angle_min {angle_min} and increment {increment}")
        self.angle_min = angle_min
        self.increment = increment
        self.samples = samples
        angles = [angle_min + increment * i for i in range(samples)]
        # Not NumPy's sine and cosine: their last bits depend on the processor's vector instructions.
        self._dx, self._dy = (np.array([function(angle) for angle in angles]) for function in (math.cos, math.sin))
        self._struct = FanStruct(
            angle_min,
            1.0 / increment,
            (samples - 1) * increment + 2.0 * TOLERANCE,
            samples,
            address("dx", self._dx, (samples,)),
            address("dy", self._dy, (samples,)),
        )

    def scan(self, scene: Scene, robots: Sequence[int], max_range: float = math.inf) -> np.ndarray:
        """Distances (r, samples) [m] seen by these robots' scanners; +inf where nothing is within max_range [m].

        From inside a circle its far side is seen; a segment is seen from both sides. A scan does not
        depend on which other robots are in `robots`. ValueError for an unknown robot or a pose that is not finite.
        """
        numbers = np.ascontiguousarray(robots, dtype=np.int64)
        distances = np.empty((len(numbers), self.samples))
        status = scene.aro_cast(
            ctypes.byref(self._struct),
            ctypes.byref(scene.struct),
            len(numbers),
            address("robots", numbers, (None,), np.int64),
            max_range,
            address("distances", distances, (len(numbers), self.samples)),
        )
        if status:
            raise ValueError(REFUSED[status])
        return distances

    def cast(self, world_from_scans: np.ndarray, walls: CrossSection, reach: float = math.inf) -> np.ndarray:
        """Distances (r, samples) [m] from poses (r, 3) [x m, y m, yaw rad]; +inf where nothing is within `reach` [m].

        For repeated scans in one world a Scene is faster.
        """
        poses = np.ascontiguousarray(world_from_scans, dtype=np.float64)
        address("world_from_scans", poses, (None, 3))
        scene = Scene([ScanPlane(walls)], [0] * len(poses), np.zeros_like(poses))
        scene.footprints[:] = poses
        return self.scan(scene, range(len(poses)), reach)
