"""Measurements of the IMU."""

import numpy as np
import pytest

from aro_robocop_goto_as.geometry import STANDARD_GRAVITY, Pose3D
from aro_robocop_goto_as.robot.model import BodyState
from aro_robocop_goto_as.sensors import imu
from aro_robocop_goto_as.sensors.imu import ImuParams

STANDING = BodyState(Pose3D(), (0.0, 0.0, 0.0), (0.0, 0.0, 0.0))
EXACT = ImuParams(0.0, 0.0)


def _measured(before, after, dt, at):
    return imu.measure(before, after, dt, Pose3D(at), EXACT, np.random.Generator(np.random.Philox(1)))


def test_off_centre_imu_measures_the_acceleration_at_its_mounting_point():
    before = BodyState(Pose3D(), (0.0, 0.0, 0.0), (0.0, 0.0, 1.0))
    after = BodyState(Pose3D(), (0.1, 0.0, 0.0), (0.0, 0.0, 2.0))
    sample = _measured(before, after, 0.1, (-0.032, 0.0, 0.068))
    assert sample[imu.FORCE] == pytest.approx([1.0, -0.32, STANDARD_GRAVITY])
    assert sample[imu.RATES] == pytest.approx([0.0, 0.0, 2.0])


def test_noise_has_the_configured_sigmas_and_bias():
    rng = np.random.Generator(np.random.Philox(1))
    params = ImuParams(gyro_noise=0.1, accelerometer_noise=0.2, accelerometer_bias=0.5)
    samples = [imu.measure(STANDING, STANDING, 0.01, Pose3D(), params, rng) for _ in range(500)]
    accelerations = np.array([sample[imu.FORCE] for sample in samples]) - [0.0, 0.0, STANDARD_GRAVITY]
    assert np.std([sample[imu.RATES] for sample in samples]) == pytest.approx(0.1, rel=0.1)
    assert (accelerations.std(), accelerations.mean()) == (pytest.approx(0.2, rel=0.1), pytest.approx(0.5, abs=0.03))
