"""The wheels' joints, as the encoders read them."""

from dataclasses import dataclass

import numpy as np

from ..param_loading import parameter
from .odometry import Odometers
from .sensor import Calls, Robots, Sensor, Site

JOINTS = "joints"


@dataclass(frozen=True)
class JointParams:
    """How often the joints are read."""

    joint_state_rate: int = parameter(30, low=1)  # [Hz]


class Joints(Sensor):
    """angles: (n, 2) of the wheels [rad], left and right; their speeds are the fleet's."""

    name = JOINTS

    def __init__(self, params: JointParams, site: Site, odometry: Odometers) -> None:
        self.rate = params.joint_state_rate
        self.angles = np.zeros((len(site.fleet), 2))
        self._engine, self._odometry = site.engine, odometry

    def measuring(self, _robots: Robots) -> Calls:
        """Read the joints of all robots."""
        return [self._engine.update_fleet, self._read]

    def _read(self) -> None:
        self.angles[:] = self._odometry.joint_angles()
