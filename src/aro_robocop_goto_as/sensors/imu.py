"""BodyState -> what a gyro with accelerometer measures."""

from dataclasses import dataclass

import numpy as np

from ..geometry import STANDARD_GRAVITY, Pose3D, Quaternion, compose3, rotation_matrix
from ..robot import BodyState


@dataclass(frozen=True)
class ImuSample:
    """Orientation of imu_link in the world; rates [rad/s] and specific force [m/s^2], (3,) each, in imu_link."""

    orientation: Quaternion
    angular_velocity: np.ndarray
    linear_acceleration: np.ndarray


def _point_velocity(state: BodyState, offset: np.ndarray) -> np.ndarray:
    """Velocity (3,) [m/s] in the world of a point at `offset` (3,) [m] from base_link, in world axes."""
    return np.array(state.linear_velocity) + np.cross(state.angular_velocity, offset)


def measure(before: BodyState, after: BodyState, dt: float, base_from_imu: Pose3D,
            gyro_noise: float, accelerometer_noise: float, rng: np.random.Generator) -> ImuSample:
    """One sample over the step `dt` [s] between two states; at rest it reads +g upwards (REP-145)."""
    base = np.array(base_from_imu.position)
    velocity_before = _point_velocity(before, rotation_matrix(before.world_from_base.orientation) @ base)
    velocity_after = _point_velocity(after, rotation_matrix(after.world_from_base.orientation) @ base)
    world_from_imu = compose3(after.world_from_base, base_from_imu)
    imu_from_world = rotation_matrix(world_from_imu.orientation).T
    force = (velocity_after - velocity_before) / dt + np.array([0.0, 0.0, STANDARD_GRAVITY])
    return ImuSample(
        orientation=world_from_imu.orientation,
        angular_velocity=imu_from_world @ np.array(after.angular_velocity) + rng.normal(0.0, gyro_noise, 3),
        linear_acceleration=imu_from_world @ force + rng.normal(0.0, accelerometer_noise, 3),
    )
