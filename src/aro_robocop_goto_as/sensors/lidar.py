"""The lidar: raycast measures along its beams, lidar.c adds noise and the lidar's other errors."""

import ctypes
import math
from functools import partial
from typing import Callable, Sequence

import numpy as np

from ..compiled import address, structure
from ..raycast.beams import Beams
from ..raycast.caster_library import load
from .lidar_profiles import LidarParams, LidarProfile
from .sensor import Episode, MeasurementCalls, RobotIndices, Sensor, SensorContext

SCAN = "scan"

_Lidar = structure("sensors/lidar.c", "lidar")


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
        self._mounts = tuple(model.base_from_scan for model in context.models)
        self._errors = RangeErrors(self.profile)

    def measurement_calls(self, robots: RobotIndices) -> MeasurementCalls:
        """Scan with these robots' lidars."""
        cast = self._beams.casting(self.context.scenes.scene(self._mounts), robots, self.profile.range_max, self.ranges)
        return MeasurementCalls([cast, self._errors.adding(robots, self.context.episode, self.ranges)])

    def exact_distances(self, robot: int) -> np.ndarray:
        """What a lidar would measure now without noise and range_min: (samples,) [m]; no return = +inf."""
        return self._beams.scan(self.context.scenes.scene(self._mounts), [robot], self.profile.range_max)[0]
