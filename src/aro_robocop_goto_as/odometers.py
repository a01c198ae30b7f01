"""All robots' wheel angles -> their odometry, with the errors that are asked for."""

from typing import List, Sequence

import numpy as np

from .params import SimParams
from .robot import Pair, RobotModel, RobotState
from .sensors import encoders, odometry
from .sensors.encoders import Encoders
from .sensors.odometry import Odometry


class Odometers:
    """One odometry a robot, starting at zero."""

    def __init__(self, p: SimParams, models: Sequence[RobotModel], states: Sequence[RobotState]) -> None:
        self._dt = 1.0 / p.odom_rate
        self._slip, self._tick = p.odom_slip, p.encoder_tick
        radii = [model.wheel_radius * (1.0 + p.odom_wheel_radius_error) for model in models]
        self._wheels = list(zip(radii, (model.wheel_separation for model in models)))
        self._encoders = [Encoders(state.wheel_angles, state.wheel_angles) for state in states]
        self.latest = [odometry.starting(self.read(state.wheel_angles)) for state in states]

    @property
    def slipping(self) -> bool:
        """Whether an update needs noise."""
        return self._slip > 0.0

    def read(self, wheel_angles: Pair) -> Pair:
        """Wheel angles [rad] as encoders that don't slip show them."""
        return encoders.ticked(wheel_angles, self._tick) if self._tick else wheel_angles

    def slip(self, states: Sequence[RobotState], noise: np.ndarray) -> None:
        """Have encoders count further, noise (n, 2) standard normal; to be called before each update of such."""
        self._encoders = [encoders.count(before, state.wheel_angles, self._slip, row)
                          for before, state, row in zip(self._encoders, states, noise)]

    def update(self, states: Sequence[RobotState]) -> List[Odometry]:
        """The next odometry of all robots."""
        angles = [it.counted for it in self._encoders] if self._slip else [it.wheel_angles for it in states]
        self.latest = [odometry.integrate(before, self.read(pair), self._dt, radius, separation)
                       for before, pair, (radius, separation) in zip(self.latest, angles, self._wheels)]
        return self.latest
