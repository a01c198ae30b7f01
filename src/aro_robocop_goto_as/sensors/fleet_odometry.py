"""The wheel odometry of all robots, with its configured errors."""

from typing import List, Sequence

import numpy as np

from ..component_params import OdometryParams
from ..robot.model import Pair, RobotModel, RobotState
from . import encoders, odometry
from .encoders import Encoders
from .odometry import Odometry


class Odometers:
    """One odometry per robot, starting at zero."""

    def __init__(self, params: OdometryParams, models: Sequence[RobotModel], states: Sequence[RobotState]) -> None:
        self._dt = 1.0 / params.rate
        self._slip, self._tick = params.slip, params.encoder_tick
        radii = [model.wheel_radius * (1.0 + params.wheel_radius_error) for model in models]
        self._wheels = list(zip(radii, (model.wheel_separation for model in models)))
        self._encoders = [Encoders(state.wheel_angles, state.wheel_angles) for state in states]
        self.latest = [odometry.starting(self.read(state.wheel_angles)) for state in states]

    @property
    def slipping(self) -> bool:
        """Whether slip must be called before each update."""
        return self._slip > 0.0

    def read(self, wheel_angles: Pair) -> Pair:
        """Wheel angles [rad] at the resolution of the encoders, without slip."""
        return encoders.ticked(wheel_angles, self._tick) if self._tick else wheel_angles

    def joint_state(self, state: RobotState) -> RobotState:
        """The state with its wheel angles as the encoders read them."""
        return state._replace(wheel_angles=self.read(state.wheel_angles)) if self._tick else state

    def slip(self, states: Sequence[RobotState], noise: np.ndarray) -> None:
        """Advance the encoders of slipping wheels; noise: (n, 2) standard normal. To be called before each update."""
        self._encoders = [
            encoders.count(before, state.wheel_angles, self._slip, row)
            for before, state, row in zip(self._encoders, states, noise)
        ]

    def update(self, states: Sequence[RobotState]) -> List[Odometry]:
        """The odometry of all robots at the next period."""
        angles = (
            [encoder.counted for encoder in self._encoders] if self._slip else [state.wheel_angles for state in states]
        )
        self.latest = [
            odometry.integrate(before, self.read(pair), self._dt, radius, separation)
            for before, pair, (radius, separation) in zip(self.latest, angles, self._wheels)
        ]
        return self.latest
