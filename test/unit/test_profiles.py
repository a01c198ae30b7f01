"""Profiles and defaults: command timeout, limits, encoders, topics; odometry errors and simple sensors."""

import math
import os
from typing import Any, Callable, Dict

import numpy as np
import pytest
import yaml
from support import ROOT, everything, model_named

from aro_robocop_goto_as.geometry import Pose2D, Twist2D, quaternion_from_rpy, wrap_angle
from aro_robocop_goto_as.param_loading import from_dict
from aro_robocop_goto_as.params import SimParams
from aro_robocop_goto_as.robot.base_controller import limits_from
from aro_robocop_goto_as.sensors import magnetometer
from aro_robocop_goto_as.sensors.encoders import Encoders, count, ticked
from aro_robocop_goto_as.simulation.simulator import Simulator

Make = Callable[..., Simulator]
TICK = 0.001533981  # [rad] of a TurtleBot3's encoders


def _profile(name: str) -> Dict[str, Any]:
    with open(os.path.join(ROOT, "config", "profiles", name + ".yaml")) as stream:
        values: Dict[str, Any] = yaml.safe_load(stream)
    return values


def _params(name: str, **given: Any) -> SimParams:
    return from_dict(SimParams, {**_profile(name), **given}, name)


@pytest.mark.parametrize(
    "profile, model, expected",
    [
        ("gazebo", "burger", (0.22, 2.84, 1.0, 3.2, 0.0)),
        ("turtlebot3_gazebo", "waffle_pi", (0.26, 1.82, 1.0, 3.2, 0.0)),
        ("real", "burger", (0.2108, 2.635, 2.5, 3.2, 0.5)),
        ("real", "waffle_pi", (0.2661, 1.854, 2.5, 3.2, 0.5)),
        ("real", "turtlebot2", (1.5, 6.6, 1.0, 2.0, 0.6)),
    ],
)
def test_a_profile_sets_limits_and_command_timeout(profile: str, model: str, expected: "tuple[float, ...]") -> None:
    assert limits_from(_params(profile).limits(), model_named(model).figures) == expected


@pytest.mark.parametrize("model, timeout", [("burger", 0.5), ("waffle", 0.5), ("turtlebot2", 0.6)])
def test_without_a_profile_a_robot_brakes_after_its_models_own_timeout(model: str, timeout: float) -> None:
    assert limits_from(SimParams().limits(), model_named(model).figures).timeout == timeout


def test_turtlebot3_gazebo_profile_has_its_scanner_localization_and_cameras() -> None:
    p = _params("turtlebot3_gazebo")
    scan = p.scanner()
    assert (scan.rate, scan.spec.samples, scan.spec.range_min, scan.spec.range_max) == (5, 360, 0.12, 3.5)
    assert (p.topics().localization, p.topics().initialpose, p.topics().gazebo_topics) == ("none", False, True)
    cameras = [p.camera(f"turtlebot3_{name}") for name in ("waffle", "waffle_pi", "burger_rgbd")]
    assert [(it.width, it.height, it.angle) for it in cameras] == [
        (1920, 1080, 1.3439),
        (640, 480, 1.0856),
        (160, 120, 1.02974),
    ]
    assert _params("turtlebot3_gazebo", camera_width=80).camera("turtlebot3_waffle").width == 80
    assert SimParams().camera("turtlebot3_waffle").width == 160


def test_turtlebot3_gazebo_profile_runs(simulator: Make) -> None:
    sim = simulator("stage_1", Pose2D(0.5, 0.0), **_profile("turtlebot3_gazebo"))
    seen = [sim.step(everything(1)) for _ in range(240)]
    samples = [it.imus[0].linear_acceleration for it in seen if it is not None and it.imus]
    assert len(samples) == 240
    assert np.mean(samples, axis=0) == pytest.approx([0.1, 0.1, 9.90665], abs=0.01)
    scans = [it.scans[0] for it in seen if it is not None and it.scans]
    assert len(scans) == 5 and not np.isinf(scans[0]).any()


def test_explicit_value_overrides_the_profile() -> None:
    limits = limits_from(
        _params("real", cmd_vel_timeout=2.0, max_linear_velocity=0.3).limits(), model_named("burger").figures
    )
    assert (limits.timeout, limits.max_v, limits.max_w) == (2.0, 0.3, 2.635)


def test_real_profile_has_an_lds01_and_the_topics_of_a_turtlebot3(simulator: Make) -> None:
    assert _params("real").scanner().spec.range_max == 3.5
    sim = simulator("stage_1", **_profile("real"))
    seen = [it for it in (sim.step(everything(len(sim.robots))) for _ in range(240)) if it is not None]
    assert [sum(bool(getattr(it, name)) for it in seen) for name in ("scans", "odometry", "joints", "imus")] == [
        5,
        30,
        30,
        200,
    ]
    assert [sum(bool(getattr(it, name)) for it in seen) for name in ("magnetic_fields", "batteries", "bumpers")] == [
        200,
        30,
        0,
    ]


def test_the_real_profiles_encoders_count_ticks(simulator: Make) -> None:
    sim = simulator("empty", **_profile("real"))
    for _ in range(240):
        sim.command(Twist2D(0.1, 0.5))
        seen = sim.step({"joints": [0], "odom": [0]})
    assert seen is not None and seen.joints is not None and seen.odometry is not None
    for angles in (seen.joints[0].wheel_angles, seen.odometry[0].wheel_angles):
        assert all(angle / TICK == pytest.approx(round(angle / TICK), abs=1e-6) for angle in angles)


def test_an_encoder_counts_completed_ticks_only() -> None:
    assert ticked((0.25, -0.05), 0.1) == pytest.approx((0.2, -0.1))


def test_slip_makes_encoders_overcount_in_either_direction() -> None:
    counted = count(Encoders((1.0, 1.0), (0.0, 0.0)), (2.0, -2.0), 0.1, np.array([1.0, -2.0])).counted
    assert counted == pytest.approx((1.0 + 2.2, 1.0 - 2.4))


def _odom_and_truth(sim: Simulator) -> "tuple[Pose2D, Pose2D]":
    for _ in range(8 * sim.config.rates.physics):
        sim.command(Twist2D(0.2, 0.0))
        seen = sim.step({"odom": [0]})
    assert seen is not None and seen.odometry is not None
    return seen.odometry[0].odom_from_footprint, sim.world_from_footprint()


KINEMATIC = {"drive": "kinematic", "physics_rate": 60}


def test_a_wheel_radius_error_scales_the_distance(simulator: Make) -> None:
    odom, truth = _odom_and_truth(simulator("empty", odom_wheel_radius_error=0.02, **KINEMATIC))
    assert odom.x == pytest.approx(1.02 * truth.x)


def test_slip_makes_odometry_overestimate_and_turn_reproducibly(simulator: Make) -> None:
    odom, truth = _odom_and_truth(simulator("empty", odom_slip=0.05, **KINEMATIC))
    assert odom.x > 1.02 * truth.x
    assert odom.yaw != 0.0
    assert _odom_and_truth(simulator("empty", odom_slip=0.05, **KINEMATIC))[0] == odom
    assert _odom_and_truth(simulator("empty", odom_slip=0.05, seed=2, **KINEMATIC))[0] != odom


def test_odometry_without_errors_is_exact(simulator: Make) -> None:
    odom, truth = _odom_and_truth(simulator("empty", **KINEMATIC))
    assert (odom.x, odom.y, odom.yaw) == pytest.approx((truth.x, truth.y, truth.yaw))


@pytest.mark.parametrize("params", [{}, KINEMATIC])
def test_the_bumper_reports_walls_but_not_the_floor(simulator: Make, params: "dict[str, Any]") -> None:
    sim = simulator("stage_1", Pose2D(1.5, 0.0), **params)
    pressed = []
    for _ in range(4 * sim.config.rates.physics):
        sim.command(Twist2D(0.2, 0.0))
        seen = sim.step({"bumper": [0]})
        pressed += [seen.bumpers[0]] if seen is not None and seen.bumpers else []
    assert pressed[0] is False and pressed[-1] is True


def test_the_magnetometer_points_north_at_any_heading() -> None:
    for yaw in (0.0, 1.0, -2.0):
        x, y, z = magnetometer.measure(quaternion_from_rpy(0.0, 0.0, yaw))
        assert wrap_angle(math.atan2(y, x) + yaw) == pytest.approx(math.pi / 2.0)
        assert z < 0.0
