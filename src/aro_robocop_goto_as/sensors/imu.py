"""The measurements of an IMU: orientation, angular velocity and specific force."""

from dataclasses import dataclass

import numpy as np

from ..component_params import ImuNoise
from ..geometry import STANDARD_GRAVITY, Pose3D, Quaternion, compose3, rotation_matrix
from ..robot.model import BodyState


@dataclass(frozen=True)
class ImuSample:
    """Orientation of imu_link in the world; angular velocity (3,) [rad/s], specific force (3,) [m/s^2] in imu_link."""

    orientation: Quaternion
    angular_velocity: np.ndarray
    linear_acceleration: np.ndarray


def _point_velocity(state: BodyState, offset: np.ndarray) -> np.ndarray:
    """Velocity (3,) [m/s] in the world of a point at `offset` (3,) [m] from base_link, in world axes."""
    return np.array(state.linear_velocity) + np.cross(state.angular_velocity, offset)


def measure(
    before: BodyState,
    after: BodyState,
    dt: float,
    base_from_imu: Pose3D,
    noise: ImuNoise,
    rng: np.random.Generator,
) -> ImuSample:
    """One sample from the states before and after a step of `dt` [s]; at rest it reads +g upwards (REP-145)."""
    base = np.array(base_from_imu.position)
    velocity_before = _point_velocity(before, rotation_matrix(before.world_from_base.orientation) @ base)
    velocity_after = _point_velocity(after, rotation_matrix(after.world_from_base.orientation) @ base)
    world_from_imu = compose3(after.world_from_base, base_from_imu)
    imu_from_world = rotation_matrix(world_from_imu.orientation).T
    force = (velocity_after - velocity_before) / dt + np.array([0.0, 0.0, STANDARD_GRAVITY])
    return ImuSample(
        orientation=world_from_imu.orientation,
        angular_velocity=imu_from_world @ np.array(after.angular_velocity) + rng.normal(0.0, noise.gyro, 3),
        linear_acceleration=imu_from_world @ force + rng.normal(noise.accelerometer_bias, noise.accelerometer, 3),
    )
