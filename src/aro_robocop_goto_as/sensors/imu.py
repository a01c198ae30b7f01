"""The IMU: orientation, angular velocity and specific force."""

from dataclasses import dataclass
from functools import partial
from typing import Dict

import numpy as np

from ..geometry import STANDARD_GRAVITY, Pose3D, compose3, rotation_matrix
from ..param_loading import parameter
from ..robot.model import BodyState
from .sensor import MeasurementCalls, NoiseStreams, RateParams, RobotIndices, Sensor, SensorContext


@dataclass(frozen=True)
class ImuParams(RateParams):
    """Standard deviations of the IMU's white noise, the accelerometer's bias, and how often it measures."""

    gyro_noise: float = parameter(2e-4, 0.0, 100.0, "[rad/s] standard deviation; TurtleBot3 in Gazebo")
    accelerometer_noise: float = parameter(1.7e-2, 0.0, 100.0, "[m/s^2] standard deviation; TurtleBot3 in Gazebo")
    accelerometer_bias: float = parameter(0.0, -100.0, 100.0, "[m/s^2] added to each axis; TurtleBot3 in Gazebo: 0.1")
    imu_rate: int = parameter(200, low=1, about="[Hz] of imu; need not divide physics_rate: the mean rate is exact")


# Parts of a sample (10,): the orientation of imu_link in the world (x, y, z, w), angular velocity [rad/s] and specific
# force [m/s^2] in imu_link.
ORIENTATION, RATES, FORCE = slice(0, 4), slice(4, 7), slice(7, 10)


def _point_velocity(state: BodyState, offset: np.ndarray) -> np.ndarray:
    """Velocity (3,) [m/s] in the world of a point at `offset` (3,) [m] from base_link, in world axes."""
    return np.array(state.linear_velocity) + np.cross(state.angular_velocity, offset)


def measure(
    before: BodyState,
    after: BodyState,
    dt: float,
    base_from_imu: Pose3D,
    noise: ImuParams,
    rng: np.random.Generator,
) -> np.ndarray:
    """One sample (10,) from the states before and after a step of `dt` [s]; at rest it reads +g upwards (REP-145)."""
    base = np.array(base_from_imu.position)
    velocity_before = _point_velocity(before, rotation_matrix(before.world_from_base.orientation) @ base)
    velocity_after = _point_velocity(after, rotation_matrix(after.world_from_base.orientation) @ base)
    world_from_imu = compose3(after.world_from_base, base_from_imu)
    imu_from_world = rotation_matrix(world_from_imu.orientation).T
    force = (velocity_after - velocity_before) / dt + np.array([0.0, 0.0, STANDARD_GRAVITY])
    sample = np.empty(10)
    sample[ORIENTATION] = world_from_imu.orientation
    sample[RATES] = imu_from_world @ np.array(after.angular_velocity) + rng.normal(0.0, noise.gyro_noise, 3)
    sample[FORCE] = imu_from_world @ force + rng.normal(noise.accelerometer_bias, noise.accelerometer_noise, 3)
    return sample


class Imu(Sensor):
    """samples: (n, 10), the parts of each as described above."""

    topic = "imu"

    def __init__(self, params: ImuParams, context: SensorContext) -> None:
        super().__init__(context, params.imu_rate)
        self.params, self.samples = params, np.zeros((len(context.fleet), 10))
        self._before: Dict[int, BodyState] = {}

    def measurement_calls(self, robots: RobotIndices) -> MeasurementCalls:
        """Compare these robots' states before and after the step."""
        return MeasurementCalls([partial(self.measure, robots)], before=[partial(self._keep, robots)])

    def _keep(self, robots: RobotIndices) -> None:
        self._before = {robot: self.context.engine.body(robot) for robot in robots}

    def measure(self, robots: RobotIndices) -> None:
        """Measure these robots' IMUs over the step."""
        context = self.context
        for robot in robots:
            before, after, mount = self._before[robot], context.engine.body(robot), context.models[robot].base_from_imu
            noise = context.noise.stream(NoiseStreams.FIRST_IMU + robot)
            self.samples[robot] = measure(before, after, 1.0 / context.rate, mount, self.params, noise)
