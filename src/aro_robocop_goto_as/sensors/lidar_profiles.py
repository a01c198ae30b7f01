"""Lidars by name: beams, ranges, noise and the quirks of their drivers."""

import math
from dataclasses import dataclass, replace
from typing import Any, Dict, NamedTuple, Optional, Tuple

from ..param_loading import PROFILES_OWN, parameter, positive
from .sensor import RateParams

TURN = 2.0 * math.pi  # [rad]


class Accuracy(NamedTuple):
    """Largest error [m] of ranges up to a distance [m]: `metres` plus `share` of the range."""

    up_to: float
    metres: float
    share: float


@dataclass(frozen=True)
class LidarProfile:
    """Scans per second [Hz]; beams spread evenly from angle_min to angle_max [rad], both ends included; ranges [m]."""

    rate: int
    angle_min: float
    angle_max: float
    samples: int
    range_min: float
    range_max: float
    noise: float  # [m] sigma
    accuracy: Tuple[Accuracy, ...] = ()  # replaces the noise; in order of distance
    resolution: float = 0.0  # [m] ranges are whole multiples of it; 0: not quantised
    zero_is_none: bool = False  # no return, too near and too far are 0.0 instead of +inf, -inf, +inf (REP-117)

    @property
    def increment(self) -> float:
        """Angle between neighbouring beams [rad], computed as in Gazebo: the span over samples - 1."""
        return (self.angle_max - self.angle_min) / (self.samples - 1)


_GAZEBO = LidarProfile(10, 0.0, 6.28319, 360, 0.12, 10.0, 0.01)  # the lab's Gazebo sensor

# LDS-01: limits and quirks of its driver, noise of its Gazebo model. LDS-02: ranges and accuracy of its data sheet;
# scan rate and number of beams are estimated from about 2300 measurements per second. The real number of beams varies
# from turn to turn, as its motor's speed does within 2 %.
PROFILES: Dict[str, LidarProfile] = {
    "gazebo": _GAZEBO,
    "ideal": replace(_GAZEBO, noise=0.0),
    "lds01": LidarProfile(5, 0.0, TURN - TURN / 360, 360, 0.12, 3.5, 0.01, resolution=0.001, zero_is_none=True),
    "lds02": LidarProfile(
        10,
        0.0,
        TURN - TURN / 230,
        230,
        0.16,
        8.0,
        0.0,
        zero_is_none=True,
        accuracy=(Accuracy(0.3, 0.010, 0.0), Accuracy(6.0, 0.0, 0.03), Accuracy(8.0, 0.0, 0.05)),
    ),
}


@dataclass(frozen=True)
class LidarParams(RateParams):
    """The lidar: a profile, and figures that replace its own."""

    scan_profile: str = parameter(
        "gazebo", choices=tuple(PROFILES), about="the lab's Gazebo sensor, or others with their quirks: docs/robots.md"
    )
    scan_rate: Optional[int] = parameter(None, low=1, about="[Hz] of scan", otherwise=PROFILES_OWN)
    scan_samples: Optional[int] = parameter(
        None, 2, 100000, "beams, both ends of the span included", otherwise=PROFILES_OWN
    )
    scan_angle_min: Optional[float] = parameter(None, -10.0, 10.0, "[rad] of the first beam", otherwise=PROFILES_OWN)
    scan_angle_max: Optional[float] = parameter(None, -10.0, 10.0, "[rad] of the last beam", otherwise=PROFILES_OWN)
    scan_range_min: Optional[float] = parameter(
        None, 0.0, 1e6, "[m] nearer is -inf (REP-117), 0.0 for an LDS", otherwise=PROFILES_OWN
    )
    scan_range_max: Optional[float] = positive(
        None, "[m] farther is +inf (REP-117), 0.0 for an LDS", otherwise=PROFILES_OWN
    )
    scan_noise: Optional[float] = parameter(
        None, 0.0, 100.0, "[m] standard deviation; 0 = exact", otherwise=PROFILES_OWN
    )

    def given(self) -> Dict[str, Any]:
        """The figures that replace the profile's."""
        return {name: value for name, value in vars(self).items() if name != "scan_profile" and value is not None}

    def profile(self) -> LidarProfile:
        """The profile, with the given figures in place of its own."""
        figures = {name[len("scan_") :]: value for name, value in self.given().items()}
        if "noise" in figures:
            figures["accuracy"] = ()
        return replace(PROFILES[self.scan_profile], **figures)

    def rates(self) -> Dict[str, int]:
        """The profile's rate [Hz], or the given one."""
        return {"scan_rate": self.profile().rate}
