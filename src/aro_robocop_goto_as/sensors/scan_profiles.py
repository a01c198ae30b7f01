"""Planar laser scanners by name: beams, ranges, noise and the quirks of their drivers."""

import math
from dataclasses import dataclass, replace
from typing import Dict, NamedTuple, Tuple

TURN = 2.0 * math.pi  # [rad]


class Accuracy(NamedTuple):
    """Largest error [m] of ranges up to a distance [m]: `metres` plus `share` of the range."""

    up_to: float
    metres: float
    share: float


@dataclass(frozen=True)
class LidarSpec:
    """Beams spread evenly from angle_min to angle_max [rad], both ends included; ranges and noise sigma in [m]."""

    angle_min: float
    angle_max: float
    samples: int
    range_min: float
    range_max: float
    noise: float
    accuracy: Tuple[Accuracy, ...] = ()  # replaces the noise; in order of distance
    step: float = 0.0  # [m] ranges are whole multiples of it; 0: not quantised
    zero_is_none: bool = False  # no return, too near and too far are 0.0 instead of +inf, -inf, +inf (REP-117)
    varying: int = 0  # number of beams in a scan differs from `samples` by at most this

    @property
    def increment(self) -> float:
        """Angle between neighbouring beams [rad], computed as in Gazebo: the span over samples - 1."""
        return (self.angle_max - self.angle_min) / (self.samples - 1)

    def with_samples(self, samples: int) -> "LidarSpec":
        """The same full turn divided among another number of beams."""
        increment = self.increment * self.samples / samples
        return replace(self, samples=samples, angle_max=self.angle_min + increment * (samples - 1))


class ScanProfile(NamedTuple):
    """A scanner and its scan rate [Hz]."""

    rate: int
    spec: LidarSpec


_GAZEBO = LidarSpec(0.0, 6.28319, 360, 0.12, 10.0, 0.01)  # the lab's Gazebo sensor

# LDS-01: limits and quirks of its driver, noise of its Gazebo model. LDS-02: ranges and accuracy of its data sheet;
# scan rate and number of beams are estimated from about 2300 measurements per second and a motor speed within 2 %.
PROFILES: Dict[str, ScanProfile] = {
    "gazebo": ScanProfile(10, _GAZEBO),
    "ideal": ScanProfile(10, replace(_GAZEBO, noise=0.0)),
    "lds01": ScanProfile(5, LidarSpec(0.0, TURN - TURN / 360, 360, 0.12, 3.5, 0.01, step=0.001, zero_is_none=True)),
    "lds02": ScanProfile(
        10,
        LidarSpec(
            0.0,
            TURN - TURN / 230,
            230,
            0.16,
            8.0,
            0.0,
            zero_is_none=True,
            varying=5,
            accuracy=(Accuracy(0.3, 0.010, 0.0), Accuracy(6.0, 0.0, 0.03), Accuracy(8.0, 0.0, 0.05)),
        ),
    ),
}
