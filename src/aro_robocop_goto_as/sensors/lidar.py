"""The lidar: its profiles, and ranges: raycast measures along the beams, lidar.c adds the lidar's errors."""

import ctypes
import math
from dataclasses import dataclass, replace
from functools import partial
from typing import Any, Callable, Dict, NamedTuple, Optional, Sequence, Tuple

import numpy as np

from ..compiled import address, structure
from ..param_loading import PROFILES_OWN, parameter, positive
from ..raycast.beams import Beams, load
from .sensor import Episode, MeasurementCalls, RateParams, RobotIndices, Sensor, SensorContext

SCAN = "scan"
TURN = 2.0 * math.pi  # [rad]

_Lidar = structure("sensors/lidar.c", "lidar")


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


class RangeErrors:
    """What a lidar reports for exact distances.

    As in REP-117, too near is -inf and no return is +inf; with zero_is_none both are 0.0, as in the LDS drivers.
    """

    def __init__(self, profile: LidarProfile) -> None:
        self._samples = profile.samples
        self._accuracy = np.array(profile.accuracy, dtype=float).reshape(-1, 3)
        self._normals = np.zeros(profile.samples)
        struct = _Lidar(
            profile.range_min,
            profile.range_max,
            profile.noise,
            profile.resolution,
            *((0.0, 0.0) if profile.zero_is_none else (-math.inf, math.inf)),
            address("normals", self._normals, (profile.samples,)),
            profile.samples,
            len(self._accuracy),
            address("accuracy", self._accuracy, (None, 3)),
        )
        self._as_parameter_ = ctypes.pointer(struct)

    def adding(self, robots: Sequence[int], episode: Episode, ranges: np.ndarray) -> Callable[[], None]:
        """A function that turns exact distances into ranges each time it is called.

        Distances and ranges are in these robots' rows of `ranges` (n, samples) [m], as Beams.casting() fills them. The
        noise depends on seed, step and robot.
        """
        numbers = (ctypes.c_int64 * len(robots))(*robots)
        address("ranges", ranges, (None, self._samples))
        return partial(load().aro_measure, self, len(robots), numbers, ctypes.pointer(episode), ranges.ctypes)


class Lidar(Sensor):
    """ranges: (n, samples) [m] in base_scan; beam i points at angle_min + i * increment, counter-clockwise."""

    topic = SCAN

    def __init__(self, params: LidarParams, context: SensorContext) -> None:
        self.profile = params.profile()
        super().__init__(context, self.profile.rate)
        self.ranges = np.zeros((len(context.fleet), self.profile.samples))
        self._beams = Beams(self.profile.angle_min, self.profile.increment, self.profile.samples)
        self.mounts = tuple(model.base_from_scan for model in context.models)
        self._errors = RangeErrors(self.profile)

    def measurement_calls(self, robots: RobotIndices) -> MeasurementCalls:
        """Scan with these robots' lidars."""
        cast = self._beams.casting(self.context.scenes.scene(self.mounts), robots, self.profile.range_max, self.ranges)
        return MeasurementCalls([cast, self._errors.adding(robots, self.context.episode, self.ranges)])

    def exact_distances(self, robot: int) -> np.ndarray:
        """What a lidar would measure now without noise and range_min: (samples,) [m]; no return = +inf."""
        return self._beams.scan(self.context.scenes.scene(self.mounts), [robot], self.profile.range_max)[0]
