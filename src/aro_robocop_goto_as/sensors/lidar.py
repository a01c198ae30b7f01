"""Planar laser scanners: raycast measures along their beams, lidar.c adds noise and the scanner's other errors."""

import ctypes
import math
from functools import partial
from typing import Callable, Dict, Sequence

import numpy as np

from ..compiled import address, members
from ..raycast.beams import Fan
from ..raycast.caster_library import load
from .scan_profiles import LidarSpec, ScanParams
from .sensor import Calls, Episode, Robots, Sensor, Site

SCAN = "scan"
STREAM = 0  # of the noise of the number of beams


class _LidarStruct(ctypes.Structure):
    """`struct lidar` of lidar.c."""

    _fields_ = [
        *members(ctypes.c_double, "range_min range_max noise step too_near no_return"),
        ("normals", ctypes.c_void_p),
        *members(ctypes.c_int64, "samples n_accuracy"),
        ("accuracy", ctypes.c_void_p),
    ]


class Lidar:
    """A scanner in base_scan: beams in its x-y plane, beam i at angle_min + i * increment, counter-clockwise."""

    def __init__(self, spec: LidarSpec) -> None:
        self.spec = spec
        self.fan = Fan(spec.angle_min, spec.increment, spec.samples)
        self._turns: Dict[int, Lidar] = {}  # the same scanner by number of beams
        self._accuracy = np.array(spec.accuracy, dtype=float).reshape(-1, 3)
        self._normals = np.zeros(spec.samples)
        struct = _LidarStruct(
            spec.range_min,
            spec.range_max,
            spec.noise,
            spec.step,
            *((0.0, 0.0) if spec.zero_is_none else (-math.inf, math.inf)),  # as in REP-117, or as in the LDS drivers
            address("normals", self._normals, (spec.samples,)),
            spec.samples,
            len(self._accuracy),
            address("accuracy", self._accuracy, (None, 3)),
        )
        self._as_parameter_ = ctypes.pointer(struct)

    def next_turn(self, rng: np.random.Generator) -> "Lidar":
        """The scanner for one revolution: its number of beams varies with the motor's speed."""
        low, high = self.spec.samples - self.spec.varying, self.spec.samples + self.spec.varying
        samples = max(2, int(rng.integers(low, high, endpoint=True)))
        if samples not in self._turns:
            self._turns[samples] = Lidar(self.spec.with_samples(samples))
        return self._turns[samples]

    def measuring(self, robots: Sequence[int], episode: Episode, ranges: np.ndarray) -> Callable[[], None]:
        """A function that turns exact distances into ranges each time it is called.

        Distances and ranges are in these robots' rows of `ranges` (n, samples) [m], as Fan.casting() fills them. The
        noise depends on seed, step and robot.
        As in REP-117, too near is -inf and no return is +inf; with zero_is_none both are 0.0, as in the LDS drivers.
        """
        numbers = (ctypes.c_int64 * len(robots))(*robots)
        address("ranges", ranges, (None, self.spec.samples))
        return partial(load().aro_measure, self, len(robots), numbers, ctypes.pointer(episode), ranges.ctypes)


class Scanner(Sensor):
    """ranges: (n, n_beams) [m] in base_scan; another array where the number of beams varies."""

    name = SCAN

    def __init__(self, params: ScanParams, site: Site) -> None:
        self.lidar = Lidar(params.lidar())
        super().__init__(site, self.lidar.spec.rate)
        self._ranges: Dict[int, np.ndarray] = {}
        self.ranges = self.ranges_of(self.lidar.spec.samples)

    def ranges_of(self, beams: int) -> np.ndarray:
        """The array (n, beams) [m] to which scans with so many beams are written."""
        return self._ranges.setdefault(beams, np.zeros((len(self.site.fleet), beams)))

    def measuring(self, robots: Robots) -> Calls:
        """Scan with these robots' scanners."""
        return [lambda: self._turn(robots)] if self.lidar.spec.varying else self._scanning(self.lidar, robots)

    def _turn(self, robots: Robots) -> None:
        """Scan with as many beams as this revolution has."""
        lidar = self.lidar.next_turn(self.site.noise.stream(STREAM))
        self.ranges = self.ranges_of(lidar.spec.samples)
        for call in self._scanning(lidar, robots):
            call()

    def _scanning(self, lidar: Lidar, robots: Robots) -> Calls:
        site, ranges = self.site, self.ranges_of(lidar.spec.samples)
        cast = lidar.fan.casting(site.scanners.scene, robots, lidar.spec.range_max, ranges)
        return [cast, lidar.measuring(robots, site.episode, ranges)]
