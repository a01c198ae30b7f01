"""The magnetic field that a magnetometer measures."""

import math

import pytest

from aro_robocop_goto_as.geometry import quaternion_from_rpy, wrap_angle
from aro_robocop_goto_as.sensors import magnetometer


def test_magnetometer_points_north_at_any_heading() -> None:
    for yaw in (0.0, 1.0, -2.0):
        x, y, z = magnetometer.measure(quaternion_from_rpy(0.0, 0.0, yaw))
        assert wrap_angle(math.atan2(y, x) + yaw) == pytest.approx(math.pi / 2.0)
        assert z < 0.0
