"""Scan, odometry and IMU measurements."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from aro_robocop_goto_as.component_params import ImuNoise
from aro_robocop_goto_as.geometry import STANDARD_GRAVITY, Pose2D, Pose3D
from aro_robocop_goto_as.raycast.cross_section import Slice
from aro_robocop_goto_as.robot.model import BodyState
from aro_robocop_goto_as.sensors import imu
from aro_robocop_goto_as.sensors.lidar import Lidar
from aro_robocop_goto_as.sensors.odometry import integrate, starting
from aro_robocop_goto_as.sensors.scan_profiles import LidarSpec
from aro_robocop_goto_as.world.model import Cylinder, Obstacle, World

SPEC = LidarSpec(0.0, 6.28319, 360, 0.12, 10.0, 0.01)
RADIUS, SEPARATION = 0.033, 0.16


def _rng() -> np.random.Generator:
    return np.random.Generator(np.random.Philox(1))


def test_beam_spacing_is_that_of_the_labs_scanner() -> None:
    assert SPEC.increment == pytest.approx(6.28319 / 359)


def test_arange_as_in_lab_code_gives_one_angle_per_beam() -> None:
    assert len(np.arange(SPEC.angle_min, SPEC.angle_max + SPEC.increment, SPEC.increment)) == 360
    inc = np.float32(SPEC.increment)
    assert len(np.arange(np.float32(SPEC.angle_min), np.float32(SPEC.angle_max) + inc / 2, inc)) == 360


def test_beams_start_at_the_scanner_and_turn_counter_clockwise() -> None:
    post = World("post", (Obstacle("post", Pose3D((1.0, 4.0, 0.2)), Cylinder(0.5, 1.0)),), Pose2D(), (), "")
    distances = Lidar(SPEC).fan.cast(np.array([[1.0, 2.0, 0.0]]), Slice(post, 0.182), SPEC.range_max)[0]
    assert np.nanargmin(distances) == 90
    assert distances.min() == pytest.approx(1.5, abs=1e-3)
    assert np.isinf(distances[270])


def test_ranges_follow_rep_117() -> None:
    exact = LidarSpec(0.0, 6.28319, 360, 0.12, 10.0, 0.0)
    distances = np.full(360, 3.0)
    distances[:4] = [0.05, 0.12, np.inf, 10.0]
    assert list(Lidar(exact).measure(distances, np.zeros(360))[:4]) == [-np.inf, 0.12, np.inf, 10.0]


def test_noise_has_the_configured_sigma_and_no_bias() -> None:
    many = LidarSpec(0.0, 6.28319, 200000, 0.12, 10.0, 0.01)
    errors = Lidar(many).measure(np.full(200000, 3.0), _rng().standard_normal(200000)) - 3.0
    assert errors.std() == pytest.approx(0.01, rel=0.02)
    assert errors.mean() == pytest.approx(0.0, abs=1e-4)


@given(st.floats(-0.5, 0.5), st.floats(-5, 5), st.integers(1, 200))
def test_odometry_at_constant_wheel_speeds_follows_the_exact_arc(v: float, w: float, updates: int) -> None:
    left, right = (v - w * SEPARATION / 2) / RADIUS, (v + w * SEPARATION / 2) / RADIUS
    odometry, dt = starting((0.0, 0.0)), 1.0 / 30.0
    for i in range(1, updates + 1):
        odometry = integrate(odometry, (left * i * dt, right * i * dt), dt, RADIUS, SEPARATION)
    t = updates * dt
    chord = v * t * np.sinc(w * t / (2.0 * math.pi))
    x, y = chord * math.cos(w * t / 2.0), chord * math.sin(w * t / 2.0)
    assert (odometry.odom_from_footprint.x, odometry.odom_from_footprint.y) == pytest.approx((x, y), abs=1e-6)
    assert (odometry.twist.v, odometry.twist.w) == pytest.approx((v, w), abs=1e-6)


def _state(velocity: "tuple[float, float, float]", spin: float) -> BodyState:
    return BodyState(Pose3D(), velocity, (0.0, 0.0, spin))


def test_imu_at_rest_measures_gravity_upwards() -> None:
    sample = imu.measure(_state((0, 0, 0), 0), _state((0, 0, 0), 0), 0.01, Pose3D(), ImuNoise(0.0, 0.0), _rng())
    assert sample.linear_acceleration == pytest.approx([0.0, 0.0, STANDARD_GRAVITY])
    assert sample.angular_velocity == pytest.approx([0.0, 0.0, 0.0])


def test_off_centre_imu_measures_the_acceleration_at_its_mounting_point() -> None:
    offset = Pose3D((-0.032, 0.0, 0.068))
    sample = imu.measure(_state((0, 0, 0), 1.0), _state((0.1, 0, 0), 2.0), 0.1, offset, ImuNoise(0.0, 0.0), _rng())
    assert sample.linear_acceleration == pytest.approx([1.0, -0.32, STANDARD_GRAVITY])
    assert sample.angular_velocity == pytest.approx([0.0, 0.0, 2.0])


def test_odometry_starts_at_zero() -> None:
    assert starting((3.0, 4.0)).odom_from_footprint == Pose2D()
