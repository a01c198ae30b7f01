"""The Earth's magnetic field as a magnetometer measures it."""

import numpy as np

from ..geometry import Quaternion, rotation_matrix

# [T] in the world frame, y north and z up (REP-103): Central Europe, 20 microtesla horizontal and 44 downwards.
FIELD = np.array([0.0, 20e-6, -44e-6])


def measure(world_from_imu: Quaternion) -> np.ndarray:
    """The field (3,) [T] in imu_link, without noise."""
    return rotation_matrix(world_from_imu).T @ FIELD
