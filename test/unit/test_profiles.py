"""What a robot is like by default, as in Gazebo and as in life: its time-out, limits, encoders, topics."""

import math
import os
from typing import Any, Callable, Dict

import numpy as np
import pytest
import yaml
from support import ROOT, model_named

from aro_robocop_goto_as.drive import limits_from
from aro_robocop_goto_as.geometry import Pose2D, Twist2D, quaternion_from_rpy, wrap_angle
from aro_robocop_goto_as.params import SimParams, from_dict
from aro_robocop_goto_as.sensors import magnetometer
from aro_robocop_goto_as.sensors.encoders import Encoders, count, ticked
from aro_robocop_goto_as.simulator import Simulator

Make = Callable[..., Simulator]
TICK = 0.001533981  # [rad] of a TurtleBot3's encoders


def _profile(name: str) -> Dict[str, Any]:
    with open(os.path.join(ROOT, "config", "profiles", name + ".yaml")) as stream:
        values: Dict[str, Any] = yaml.safe_load(stream)
    return values


def _params(name: str, **given: Any) -> SimParams:
    return from_dict(SimParams, {**_profile(name), **given}, name)


@pytest.mark.parametrize("profile, model, expected", [
    ("gazebo", "burger", (0.22, 2.84, 1.0, 3.2, 0.0)),
    ("real", "burger", (0.2108, 2.635, 2.5, 3.2, 0.5)),
    ("real", "waffle_pi", (0.2661, 1.854, 2.5, 3.2, 0.5)),
    ("real", "turtlebot2", (1.5, 6.6, 1.0, 2.0, 0.6)),
])
def test_a_profile_has_the_limits_and_the_timeout_of_what_it_is_like(
        profile: str, model: str, expected: "tuple[float, ...]") -> None:
    assert limits_from(_params(profile), model_named(model).figures) == expected


def test_without_a_profile_a_robot_brakes_after_half_a_second() -> None:
    assert limits_from(SimParams(), model_named("turtlebot2").figures).timeout == 0.5


def test_what_is_given_wins_over_a_profile() -> None:
    limits = limits_from(_params("real", cmd_vel_timeout=2.0, max_linear_velocity=0.3), model_named("burger").figures)
    assert (limits.timeout, limits.max_v, limits.max_w) == (2.0, 0.3, 2.635)


def test_a_real_robot_has_an_lds01_and_sends_what_a_turtlebot3_sends(simulator: Make) -> None:
    assert _params("real").scanner().spec.range_max == 3.5
    sim = simulator("stage_1", **_profile("real"))
    seen = [it for it in (sim.step(sim.everything()) for _ in range(240)) if it is not None]
    assert [sum(bool(getattr(it, name)) for it in seen) for name in ("scans", "odometry", "joints", "imus")] == [
        5, 30, 30, 200]
    assert [sum(bool(getattr(it, name)) for it in seen) for name in ("fields", "battery", "bumpers")] == [200, 30, 0]


def test_real_encoders_count_in_ticks(simulator: Make) -> None:
    sim = simulator("empty", **_profile("real"))
    for _ in range(240):
        sim.command(Twist2D(0.1, 0.5))
        seen = sim.step({"joints": [0]})
    assert seen is not None and seen.joints is not None and seen.odometry is not None
    for angles in (seen.joints[0].wheel_angles, seen.odometry[0].wheel_angles):
        assert all(angle / TICK == pytest.approx(round(angle / TICK), abs=1e-6) for angle in angles)


def test_ticks_are_counted_when_they_are_full() -> None:
    assert ticked((0.25, -0.05), 0.1) == pytest.approx((0.2, -0.1))


def test_encoders_of_slipping_wheels_count_more_than_was_rolled_in_either_direction() -> None:
    counted = count(Encoders((1.0, 1.0), (0.0, 0.0)), (2.0, -2.0), 0.1, np.array([1.0, -2.0])).counted
    assert counted == pytest.approx((1.0 + 2.2, 1.0 - 2.4))


def _odom_and_truth(sim: Simulator) -> "tuple[Pose2D, Pose2D]":
    for _ in range(8 * sim.params.physics_rate):
        sim.command(Twist2D(0.2, 0.0))
        seen = sim.step({})
    assert seen is not None and seen.odometry is not None
    return seen.odometry[0].odom_from_base, sim.world_from_base()


KINEMATIC = {"drive": "kinematic", "physics_rate": 60}


def test_wheels_taken_for_larger_than_they_are_stretch_the_way(simulator: Make) -> None:
    odom, truth = _odom_and_truth(simulator("empty", odom_wheel_radius_error=0.02, **KINEMATIC))
    assert odom.x == pytest.approx(1.02 * truth.x)


def test_slip_makes_odometry_run_ahead_and_turn_away_the_same_in_each_run(simulator: Make) -> None:
    odom, truth = _odom_and_truth(simulator("empty", odom_slip=0.05, **KINEMATIC))
    assert odom.x > 1.02 * truth.x
    assert odom.yaw != 0.0
    assert _odom_and_truth(simulator("empty", odom_slip=0.05, **KINEMATIC))[0] == odom
    assert _odom_and_truth(simulator("empty", odom_slip=0.05, seed=2, **KINEMATIC))[0] != odom


def test_odometry_without_errors_is_exact(simulator: Make) -> None:
    odom, truth = _odom_and_truth(simulator("empty", **KINEMATIC))
    assert (odom.x, odom.y, odom.yaw) == pytest.approx((truth.x, truth.y, truth.yaw))


@pytest.mark.parametrize("params", [{}, KINEMATIC])
def test_the_bumper_tells_of_walls_and_not_of_the_floor(simulator: Make, params: "dict[str, Any]") -> None:
    sim = simulator("stage_1", Pose2D(1.5, 0.0), **params)
    told = []
    for _ in range(4 * sim.params.physics_rate):
        sim.command(Twist2D(0.2, 0.0))
        seen = sim.step({"bumper": [0]})
        told += [seen.bumpers[0]] if seen is not None and seen.bumpers else []
    assert told[0] is False and told[-1] is True


def test_a_magnetometer_finds_north_in_whatever_direction_it_looks() -> None:
    for yaw in (0.0, 1.0, -2.0):
        x, y, z = magnetometer.measure(quaternion_from_rpy(0.0, 0.0, yaw))
        assert wrap_angle(math.atan2(y, x) + yaw) == pytest.approx(math.pi / 2.0)
        assert z < 0.0
