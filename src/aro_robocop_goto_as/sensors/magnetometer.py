"""Orientation -> the earth's magnetic field as a magnetometer measures it."""

import numpy as np

from ..geometry import Quaternion, rotation_matrix

# [T] in the world, y to the north (REP-103) and z up: middle Europe's, 20 microtesla along the ground and 44 into it.
FIELD = np.array([0.0, 20e-6, -44e-6])


def measure(world_from_imu: Quaternion) -> np.ndarray:
    """The field (3,) [T] in imu_link, without noise."""
    return rotation_matrix(world_from_imu).T @ FIELD
