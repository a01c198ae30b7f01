"""Poses + the world's cut at the scanner's height -> the ranges of a planar laser scanner."""

from dataclasses import dataclass
from typing import Optional

import numpy as np

from ..raycast import Fan
from ..slice import Slice


@dataclass(frozen=True)
class LidarSpec:
    """Beams spread evenly from angle_min to angle_max [rad], both ends included; ranges and noise sigma [m]."""

    angle_min: float
    angle_max: float
    samples: int
    range_min: float
    range_max: float
    noise: float

    @property
    def increment(self) -> float:
        """Angle between neighbouring beams [rad], as Gazebo counts it: the span over samples - 1."""
        return (self.angle_max - self.angle_min) / (self.samples - 1)


class Lidar:
    """A scanner in base_scan: beams in its x-y plane, beam i at angle_min + i * increment, counter-clockwise."""

    def __init__(self, spec: LidarSpec) -> None:
        self.spec = spec
        self._fan = Fan(spec.angle_min, spec.increment, spec.samples)

    def distances(self, world_from_scans: np.ndarray, walls: Slice, others: Optional[np.ndarray] = None) -> np.ndarray:
        """Exact distances (r, samples) [m] from poses (r, 3); +inf where nothing is within range_max.

        Beams start at the scanner's centre, not at range_min, so that they carry no offset. `others` as in Fan.cast.
        """
        return self._fan.cast(world_from_scans, walls, others, self.spec.range_max)

    def measure(self, distances: np.ndarray, noise: np.ndarray) -> np.ndarray:
        """Ranges [m] by REP-117: noise (standard normal, scaled here) added, too near = -inf, no return = +inf."""
        ranges = distances + self.spec.noise * noise
        ranges[ranges < self.spec.range_min] = -np.inf
        ranges[ranges > self.spec.range_max] = np.inf
        return ranges
