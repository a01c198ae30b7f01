"""Wheel odometry and its errors; odometry.c against its definition."""

import math
from typing import List, Tuple

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from reference_fleet import ReferenceOdometry
from support import model_named

from aro_robocop_goto_as.geometry import Pose2D, wrap_angle
from aro_robocop_goto_as.robot.base_controller import Limits
from aro_robocop_goto_as.robot.fleet import Fleet
from aro_robocop_goto_as.sensors.odometry import Odometers, OdometryParams

LIMITS = Limits(1.0, 1.0, 1.0, 1.0, 0.0)
RADIUS, SEPARATION = 0.033, 0.16
Pair = Tuple[float, float]
pairs = st.tuples(st.floats(-3.0, 3.0), st.floats(-3.0, 3.0))


def _fleet(robots: int = 1) -> Fleet:
    return Fleet([model_named("burger")] * robots, [LIMITS] * robots, [0.1] * robots)


@given(
    st.lists(st.tuples(pairs, pairs), min_size=1, max_size=30),
    st.sampled_from([0.0, 0.05, 0.7]),
    st.sampled_from([0.0, 0.0015, 0.5]),
    st.sampled_from([0.0, -0.02]),
)
def test_odometry_is_that_of_the_definition(
    travel: List[Tuple[Pair, Pair]], slip: float, tick: float, error: float
) -> None:
    fleet = _fleet(2)
    odometers = Odometers(OdometryParams("encoders", error, slip, tick), fleet, 30)
    assert odometers.slipping == (slip > 0.0)
    expected = ReferenceOdometry(RADIUS * (1.0 + error), SEPARATION, slip, tick)
    for turned, noise in travel:
        fleet.wheel_angles[1] += turned
        foreseen = odometers.pose_now(1)
        odometers.noise[:] = (9.0, 9.0), noise
        odometers.update()
        expected.update(fleet.wheel_angles[1], np.array(noise), 1.0 / 30.0)
        x, y, yaw = odometers.poses[1].tolist()
        assert (x, y) == pytest.approx((expected.pose.x, expected.pose.y), abs=1e-8)
        assert wrap_angle(yaw - expected.pose.yaw) == pytest.approx(0.0, abs=1e-9)
        assert odometers.twists[1] == pytest.approx(expected.twist, abs=1e-9)
        if not slip:
            assert foreseen == (x, y, yaw)
    assert not odometers.poses[0].any() and not odometers.twists[0].any(), "the other robot stands"


@given(st.floats(-0.5, 0.5), st.floats(-5, 5), st.integers(1, 200))
def test_odometry_at_constant_wheel_speeds_follows_the_exact_arc(v: float, w: float, updates: int) -> None:
    fleet = _fleet()
    odometers = Odometers(OdometryParams(), fleet, 30)
    for update in range(1, updates + 1):
        travelled = update / 30.0 * np.array([v - w * SEPARATION / 2, v + w * SEPARATION / 2])
        fleet.wheel_angles[0] = travelled / RADIUS
        odometers.update()
    t = updates / 30.0
    chord = v * t * np.sinc(w * t / (2.0 * math.pi))
    expected = chord * math.cos(w * t / 2.0), chord * math.sin(w * t / 2.0)
    assert odometers.poses[0, :2] == pytest.approx(expected, abs=1e-6)
    assert odometers.twists[0] == pytest.approx((v, w), abs=1e-6)


def test_odometry_of_the_world_has_no_errors() -> None:
    fleet = _fleet()
    fleet.place(0, Pose2D(1.0, 2.0, 3.0))
    odometers = Odometers(OdometryParams("world", 0.1, 0.1, 0.1), fleet, 30)
    assert not odometers.slipping and odometers.poses[0].tolist() == [1.0, 2.0, 3.0]
    fleet.poses[0], fleet.twists[0] = (4.0, 5.0, 6.0), (0.1, 0.2)
    assert odometers.pose_now(0) == (4.0, 5.0, 6.0) and odometers.poses[0, 0] == 1.0
    odometers.update()
    assert odometers.poses[0].tolist() == [4.0, 5.0, 6.0] and odometers.twists[0].tolist() == [0.1, 0.2]
