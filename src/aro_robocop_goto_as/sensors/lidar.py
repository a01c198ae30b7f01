"""A planar laser scanner: exact distances in a cross-section of the world, and ranges with the scanner's errors."""

from typing import Dict

import numpy as np

from ..raycast.beams import Fan
from .scan_profiles import LidarSpec


class Lidar:
    """A scanner in base_scan: beams in its x-y plane, beam i at angle_min + i * increment, counter-clockwise."""

    def __init__(self, spec: LidarSpec) -> None:
        self.spec = spec
        self.fan = Fan(spec.angle_min, spec.increment, spec.samples)
        self._turns: Dict[int, Lidar] = {}  # the same scanner by number of beams

    def next_turn(self, rng: np.random.Generator) -> "Lidar":
        """The scanner for one revolution, whose number of beams varies with the speed of the scanner's motor."""
        if not self.spec.varying:
            return self
        low, high = self.spec.samples - self.spec.varying, self.spec.samples + self.spec.varying
        samples = max(2, int(rng.integers(low, high, endpoint=True)))
        if samples not in self._turns:
            self._turns[samples] = Lidar(self.spec.with_samples(samples))
        return self._turns[samples]

    def measure(self, distances: np.ndarray, noise: np.ndarray) -> np.ndarray:
        """Ranges [m] from exact distances [m] and standard normal noise, all of the same shape.

        As in REP-117, too near is -inf and no return is +inf; with zero_is_none both are 0.0, as in the LDS drivers.
        """
        spec = self.spec
        ranges = distances + (range_noise(distances, noise, spec) if spec.accuracy else spec.noise * noise)
        near, far = ranges < spec.range_min, ranges > spec.range_max
        if spec.step:
            ranges = np.round(ranges / spec.step) * spec.step
        ranges[near] = 0.0 if spec.zero_is_none else -np.inf
        ranges[far] = 0.0 if spec.zero_is_none else np.inf
        return ranges


def range_noise(distances: np.ndarray, noise: np.ndarray, spec: LidarSpec) -> np.ndarray:
    """Range errors [m] from a data sheet's accuracy, taken as two sigma and as the maximum."""
    bounds = np.array([entry.up_to for entry in spec.accuracy])
    entry = np.minimum(np.searchsorted(bounds, distances), len(bounds) - 1)
    metres, shares = (np.array([part[i] for part in spec.accuracy]) for i in (1, 2))
    limits = metres[entry] + shares[entry] * np.minimum(distances, spec.range_max)
    return limits * np.clip(noise / 2.0, -1.0, 1.0)
