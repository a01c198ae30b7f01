"""Wheel odometry and its errors; odometry.c against its definition."""

import math
from types import SimpleNamespace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from support import model_named

from aro_robocop_goto_as.geometry import Pose2D
from aro_robocop_goto_as.robot.base_controller import BaseLimits
from aro_robocop_goto_as.robot.fleet import Fleet
from aro_robocop_goto_as.sensors.odometry import OdometryParams, WheelOdometry

LIMITS = BaseLimits(1.0, 1.0, 1.0, 1.0, 0.0)
RADIUS, SEPARATION = 0.033, 0.16


def _fleet(robots=1):
    return Fleet([model_named("burger")] * robots, [LIMITS] * robots, [0.1] * robots)


def _context(fleet):
    """A context where the left wheel slips by two sigmas, and the right one by one; only their sizes count."""
    noise = SimpleNamespace(standard_normal=lambda out: np.copyto(out, [2.0, -1.0]))
    return SimpleNamespace(fleet=fleet, noise=SimpleNamespace(stream=lambda _: noise))


def _measure(odometry):
    for call in odometry.measurement_calls([0]).measure:
        call()


@given(st.floats(-0.5, 0.5), st.floats(-5, 5), st.integers(1, 200))
def test_odometry_at_constant_wheel_speeds_follows_the_exact_arc(v, w, updates):
    fleet = _fleet()
    odometry = WheelOdometry(OdometryParams(), _context(fleet))
    for update in range(1, updates + 1):
        travelled = update / 30.0 * np.array([v - w * SEPARATION / 2, v + w * SEPARATION / 2])
        fleet.wheel_angles[0] = travelled / RADIUS
        odometry.update()
    t = updates / 30.0
    chord = v * t * np.sinc(w * t / (2.0 * math.pi))
    expected = chord * math.cos(w * t / 2.0), chord * math.sin(w * t / 2.0)
    assert odometry.poses[0, :2] == pytest.approx(expected, abs=1e-6)
    assert odometry.twists[0] == pytest.approx((v, w), abs=1e-6)


@pytest.mark.parametrize(
    "params, x, yaw",
    [
        (OdometryParams(odom_wheel_radius_error=0.1), 1.1 * 0.033, 0.0),
        (OdometryParams(odom_slip=0.1), 0.033 * (1.2 + 1.1) / 2.0, 0.033 * (1.1 - 1.2) / 0.16),
        (OdometryParams(encoder_tick=0.3), 0.9 * 0.033, 0.0),
    ],
)
def test_each_error_of_odometry_has_its_size_and_a_reset_forgets_it(params, x, yaw):
    fleet = _fleet()
    odometry = WheelOdometry(params, _context(fleet))
    fleet.wheel_angles[0] = 1.0, 1.0  # [rad]
    _measure(odometry)
    chord = x * np.sinc(yaw / (2.0 * math.pi))
    assert odometry.poses[0] == pytest.approx((chord * math.cos(yaw / 2.0), chord * math.sin(yaw / 2.0), yaw))
    fleet.wheel_angles[0] = 9.0, 9.0
    odometry.reset([Pose2D()])
    _measure(odometry)
    assert odometry.poses[0] == pytest.approx((0.0, 0.0, 0.0))


def test_pose_now_is_that_of_the_next_update_without_its_slip():
    fleet = _fleet()
    odometry = WheelOdometry(OdometryParams(odom_slip=0.1), _context(fleet))
    _measure(odometry)
    fleet.wheel_angles[0] = 1.0, 1.0
    assert odometry.pose_now(0) == pytest.approx((0.033, 0.0, 0.0))
    assert odometry.poses[0].tolist() == [0.0, 0.0, 0.0]
    _measure(odometry)
    assert odometry.poses[0, 0] == pytest.approx(0.033 * (1.2 + 1.1) / 2.0, rel=1e-3)
