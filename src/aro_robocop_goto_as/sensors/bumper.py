"""The bumper: whether a robot touches anything but the floor."""

from dataclasses import dataclass
from typing import Mapping

from ..param_loading import parameter
from .sensor import RateParams, RobotIndices, Sensor, SensorContext


@dataclass(frozen=True)
class BumperParams(RateParams):
    """How often the bumper is read."""

    bumper_rate: int = parameter(30, low=0, about="[Hz] of bumper; 0 = not published")


class Bumper(Sensor):
    """touching: whether each robot touches something; only robots whose bumper was due last are in it."""

    topic = "bumper"

    def __init__(self, params: BumperParams, context: SensorContext) -> None:
        super().__init__(context, params.bumper_rate)
        self.touching: Mapping[int, bool] = {}

    def measure(self, robots: RobotIndices) -> None:
        """Read these robots' bumpers."""
        self.touching = {robot: self.context.engine.touching(robot) for robot in robots}
