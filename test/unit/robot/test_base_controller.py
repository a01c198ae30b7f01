"""Limits and commands of base controllers, and base_controller.c against its definition."""

import math

import pytest
from support import model_named

from aro_robocop_goto_as.errors import CommandError
from aro_robocop_goto_as.geometry import Twist2D
from aro_robocop_goto_as.robot.base_controller import BaseLimits, clamped, limits_from
from aro_robocop_goto_as.simulation.params import SimParams


@pytest.mark.parametrize("bad", [Twist2D(math.nan, 0.0), Twist2D(0.0, math.inf), Twist2D(-math.inf, math.nan)])
def test_command_that_is_not_finite_is_refused_with_its_values(bad):
    with pytest.raises(CommandError, match=f"linear.x {bad.v} m/s, angular.z {bad.w} rad/s"):
        clamped(bad, BaseLimits(0.22, 2.84, 2.5, 3.2, 0.5))


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_command_beyond_the_velocity_limits_is_clamped_to_them(sign):
    limits = BaseLimits(0.22, 2.84, 2.5, 3.2, 0.5)
    assert clamped(Twist2D(sign * 0.3, sign * 1.0), limits) == Twist2D(sign * 0.22, sign * 1.0)
    assert clamped(Twist2D(sign * 0.1, sign * 5.0), limits) == Twist2D(sign * 0.1, sign * 2.84)


def test_limits_and_timeout_are_the_models_own_unless_a_parameter_overrides_them():
    burger, turtlebot2 = (model_named(name).figures for name in ("burger", "turtlebot2"))
    assert limits_from(SimParams().limits, burger) == (0.22, 2.84, 2.5, 3.2, 0.5)
    assert limits_from(SimParams().limits, turtlebot2) == (1.5, 6.6, 1.0, 2.0, 0.6)
    given = SimParams.of(max_linear_velocity=0.1, cmd_vel_timeout=0.0).limits
    assert limits_from(given, burger) == (0.1, 2.84, 2.5, 3.2, 0.0)


def test_command_is_approached_within_its_acceleration_and_dropped_after_its_timeout(simulator):
    sim = simulator("empty", drive="kinematic", max_linear_acceleration=1.2, cmd_vel_timeout=0.5)
    sim.command(Twist2D(0.2))
    speeds = []
    for _ in range(sim.rate):
        sim.advance({})
        speeds.append(float(sim.fleet.velocities[0, 0]))
    assert speeds[:3] == pytest.approx([0.005, 0.010, 0.015])
    assert speeds[45:115] == [0.2] * 70 and max(speeds[125:]) < 0.2
    assert speeds[165:] == [0.0] * 75
