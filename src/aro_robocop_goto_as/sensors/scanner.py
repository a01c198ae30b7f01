"""The laser scanners of all robots, which also see each other: exact distances, made ranges by lidar.py."""

from typing import Dict

import numpy as np

from .lidar import Lidar
from .scan_profiles import ScanParams
from .sensor import Calls, Robots, Sensor, Site

SCAN = "scan"
STREAM = 0  # of the noise of the number of beams


class Scanner(Sensor):
    """ranges: (n, n_beams) [m] in base_scan; another array where the number of beams varies."""

    name = SCAN

    def __init__(self, params: ScanParams, site: Site) -> None:
        super().__init__(site, params.rate)
        self.lidar = Lidar(params.lidar())
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
