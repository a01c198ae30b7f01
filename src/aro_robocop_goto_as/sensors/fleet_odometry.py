"""The wheel odometry of all robots, with its configured errors."""

from typing import List, Sequence

import numpy as np

from ..component_params import OdometryParams
from ..geometry import Pose2D
from ..robot.model import Pair, RobotModel, RobotState
from . import encoders, odometry
from .encoders import Encoders
from .odometry import Odometry


class Odometers:
    """One odometry per robot: wheel odometry that starts at zero, or the true pose in the world."""

    def __init__(self, params: OdometryParams, models: Sequence[RobotModel], states: Sequence[RobotState]) -> None:
        self._dt = 1.0 / params.rate
        self.in_world = params.source == "world"
        self._slip, self._tick = params.slip, params.encoder_tick
        radii = [model.wheel_radius * (1.0 + params.wheel_radius_error) for model in models]
        self._wheels = list(zip(radii, (model.wheel_separation for model in models)))
        self._encoders = [Encoders(state.wheel_angles, state.wheel_angles) for state in states]
        self.latest = [
            _true(state) if self.in_world else odometry.starting(self.read(state.wheel_angles)) for state in states
        ]

    @property
    def slipping(self) -> bool:
        """Whether slip must be called before each update."""
        return self._slip > 0.0 and not self.in_world

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
        if self.in_world:
            self.latest = [_true(state) for state in states]
            return self.latest
        angles = (
            [encoder.counted for encoder in self._encoders] if self._slip else [state.wheel_angles for state in states]
        )
        self.latest = [
            odometry.integrate(before, self.read(pair), self._dt, radius, separation)
            for before, pair, (radius, separation) in zip(self.latest, angles, self._wheels)
        ]
        return self.latest

    def pose_now(self, robot: int, state: RobotState) -> Pose2D:
        """odom_from_footprint of a robot as the next update will see it, for a time between two updates."""
        if self.in_world:
            return state.world_from_footprint
        before, encoder = self.latest[robot], self._encoders[robot]
        counted = state.wheel_angles
        if self._slip:  # without the slip that the next update draws
            left, right = (encoder.counted[i] + counted[i] - encoder.wheel_angles[i] for i in (0, 1))
            counted = (left, right)
        radius, separation = self._wheels[robot]
        return odometry.integrate(before, self.read(counted), self._dt, radius, separation).odom_from_footprint


def _true(state: RobotState) -> Odometry:
    return Odometry(state.world_from_footprint, state.twist, state.wheel_angles)
