"""A planar laser scanner: its beams, along which raycast measures, and its errors, such as noise, added by lidar.c."""

import ctypes
import math
from typing import Dict, Sequence

import numpy as np

from ..compiled import address, members
from ..raycast.beams import Fan
from ..raycast.caster_library import load
from .scan_profiles import LidarSpec


class _LidarStruct(ctypes.Structure):
    """`struct lidar` of lidar.c."""

    _fields_ = [
        *members(ctypes.c_double, "range_min range_max noise step too_near no_return"),
        ("n_accuracy", ctypes.c_int64),
        ("accuracy", ctypes.c_void_p),
    ]


class Lidar:
    """A scanner in base_scan: beams in its x-y plane, beam i at angle_min + i * increment, counter-clockwise."""

    def __init__(self, spec: LidarSpec) -> None:
        self.spec = spec
        self.fan = Fan(spec.angle_min, spec.increment, spec.samples)
        self._turns: Dict[int, Lidar] = {}  # the same scanner by number of beams
        self._accuracy = np.array(spec.accuracy, dtype=float).reshape(-1, 3)
        self._struct = _LidarStruct(
            spec.range_min,
            spec.range_max,
            spec.noise,
            spec.step,
            *((0.0, 0.0) if spec.zero_is_none else (-math.inf, math.inf)),  # as in REP-117, or as in the LDS drivers
            len(self._accuracy),
            address("accuracy", self._accuracy, (None, 3)),
        )
        self._measure = load().aro_measure

    def next_turn(self, rng: np.random.Generator) -> "Lidar":
        """The scanner for one revolution, whose number of beams varies with the speed of the scanner's motor."""
        low, high = self.spec.samples - self.spec.varying, self.spec.samples + self.spec.varying
        samples = max(2, int(rng.integers(low, high, endpoint=True)))
        if samples not in self._turns:
            self._turns[samples] = Lidar(self.spec.with_samples(samples))
        return self._turns[samples]

    def measure(self, distances: np.ndarray, robots: Sequence[int], seed: int, step: int, ranges: np.ndarray) -> None:
        """Measure exact distances (r, samples) [m] of these robots, and write them to their rows of `ranges`.

        ranges: (n, samples) [m]. The noise depends on seed, robot and step.
        As in REP-117, too near is -inf and no return is +inf; with zero_is_none both are 0.0, as in the LDS drivers.
        """
        if robots and not 0 <= min(robots) <= max(robots) < len(ranges):
            raise ValueError(f"robots: expected numbers from 0 to {len(ranges) - 1}, got {robots}")
        samples, numbers = self.spec.samples, np.array(robots, dtype=np.int64)
        self._measure(
            ctypes.byref(self._struct),
            len(robots),
            samples,
            address("robots", numbers, (None,), np.int64),
            address("distances", distances, (len(robots), samples)),
            seed,
            step,
            address("ranges", ranges, (None, samples)),
        )
