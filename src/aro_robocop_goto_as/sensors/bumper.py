"""The bumper: whether a robot touches anything but the floor."""

from dataclasses import dataclass
from typing import Mapping

from ..param_loading import parameter
from .sensor import Calls, Robots, Sensor, Site

BUMPER = "bumper"


@dataclass(frozen=True)
class BumperParams:
    """How often the bumper is read."""

    bumper_rate: int = parameter(30, low=0, about="[Hz] of bumper; 0 = not published")


class Bumpers(Sensor):
    """touching: whether each robot touches something; only robots whose bumper was due last are in it."""

    name = BUMPER

    def __init__(self, params: BumperParams, site: Site) -> None:
        super().__init__(site, params.bumper_rate)
        self.touching: Mapping[int, bool] = {}

    def measuring(self, robots: Robots) -> Calls:
        """Read these robots' bumpers."""
        return [lambda: self._read(robots)]

    def _read(self, robots: Robots) -> None:
        self.touching = {robot: self.site.engine.touching(robot) for robot in robots}
