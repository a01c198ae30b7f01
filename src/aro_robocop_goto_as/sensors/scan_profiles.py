"""What kinds of planar laser scanners there are: figures and quirks of each."""

import math
from dataclasses import dataclass, replace
from typing import Dict, NamedTuple, Tuple

TURN = 2.0 * math.pi  # [rad]


class Accuracy(NamedTuple):
    """How far [m] a range may be off, up to a distance [m]: at most `metres`, or `share` of the distance."""

    up_to: float
    metres: float
    share: float


@dataclass(frozen=True)
class LidarSpec:
    """Beams spread evenly from angle_min to angle_max [rad], both ends included; ranges and noise sigma [m]."""

    angle_min: float
    angle_max: float
    samples: int
    range_min: float
    range_max: float
    noise: float
    accuracy: Tuple[Accuracy, ...] = ()  # in place of the noise, nearest distances first
    step: float = 0.0  # [m] ranges are whole multiples of it; 0 = any
    zero_is_none: bool = False  # no return, too near and too far are 0.0, and not +inf, -inf, +inf (REP-117)
    varying: int = 0  # beams more or less than `samples` from one turn to another, at the most

    @property
    def increment(self) -> float:
        """Angle between neighbouring beams [rad], as Gazebo counts it: the span over samples - 1."""
        return (self.angle_max - self.angle_min) / (self.samples - 1)

    def with_samples(self, samples: int) -> "LidarSpec":
        """As many beams over the same turn: each still has its increment to itself."""
        increment = self.increment * self.samples / samples
        return replace(self, samples=samples, angle_max=self.angle_min + increment * (samples - 1))


class ScanProfile(NamedTuple):
    """A scanner and how often it turns [Hz]."""

    rate: int
    spec: LidarSpec


_GAZEBO = LidarSpec(0.0, 6.28319, 360, 0.12, 10.0, 0.01)  # as the lab's Gazebo has it

# LDS-01's noise is that of its Gazebo model. LDS-02's turns and beams are estimated: some 2300 measurements a second,
# at a speed that its motor holds within two per cent.
PROFILES: Dict[str, ScanProfile] = {
    "gazebo": ScanProfile(10, _GAZEBO),
    "ideal": ScanProfile(10, replace(_GAZEBO, noise=0.0)),
    "lds01": ScanProfile(5, LidarSpec(0.0, TURN - TURN / 360, 360, 0.12, 3.5, 0.01, step=0.001, zero_is_none=True)),
    "lds02": ScanProfile(10, LidarSpec(0.0, TURN - TURN / 230, 230, 0.16, 8.0, 0.0, zero_is_none=True, varying=5,
                                       accuracy=(Accuracy(0.3, 0.010, 0.0), Accuracy(6.0, 0.0, 0.03),
                                                 Accuracy(8.0, 0.0, 0.05)))),
}
