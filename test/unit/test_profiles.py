"""The profiles in config/profiles: limits, scanners, topics and cameras of Gazebo's and of real robots."""

import os

import numpy as np
import pytest
import yaml
from support import ROOT, drive, driven, everything, model_named

from aro_robocop_goto_as.geometry import STANDSTILL, Pose2D, Twist2D
from aro_robocop_goto_as.param_loading import from_dict
from aro_robocop_goto_as.robot.base_controller import limits_from
from aro_robocop_goto_as.sensors.imu import FORCE
from aro_robocop_goto_as.simulation.params import SimParams

TICK = 0.001533981  # [rad] of a TurtleBot3's encoders


def _profile(name):
    with open(os.path.join(ROOT, "config", "profiles", name + ".yaml")) as stream:
        values = yaml.safe_load(stream)
    return values


def _params(name, **given):
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
def test_a_profile_sets_limits_and_command_timeout(profile, model, expected):
    assert limits_from(_params(profile).limits, model_named(model).figures) == expected


def test_turtlebot3_gazebo_profile_has_its_scanner_localization_and_cameras():
    p = _params("turtlebot3_gazebo")
    lidar = p.sensors.lidar.profile()
    assert (lidar.rate, lidar.samples, lidar.range_min, lidar.range_max) == (5, 360, 0.12, 3.5)
    assert (p.topics.localization, p.topics.has_initialpose, p.topics.gazebo_topics) == ("none", False, True)
    cameras = [p.sensors.camera.spec(f"turtlebot3_{name}") for name in ("waffle", "waffle_pi", "burger_rgbd")]
    assert [(camera.width, camera.height, camera.angle) for camera in cameras] == [
        (1920, 1080, 1.3439),
        (640, 480, 1.0856),
        (160, 120, 1.02974),
    ]
    assert _params("turtlebot3_gazebo", camera_width=80).sensors.camera.spec("turtlebot3_waffle").width == 80
    assert SimParams().sensors.camera.spec("turtlebot3_waffle").width == 160


def test_turtlebot3_gazebo_profile_runs(simulator):
    sim = simulator("stage_1", Pose2D(0.5, 0.0), **_profile("turtlebot3_gazebo"))
    samples, scans = [], []
    for due in drive(sim, STANDSTILL, 1.0, everything(sim)):
        samples += [sim.sensors.imu.samples[0, FORCE].copy()] if due.of("imu") else []
        scans += [sim.sensors.lidar.ranges[0].copy()] if due.of("scan") else []
    assert len(samples) == 240
    assert np.mean(samples, axis=0) == pytest.approx([0.1, 0.1, 9.90665], abs=0.01)
    assert len(scans) == 5 and not np.isinf(scans[0]).any()


def test_real_profile_has_an_lds01_and_the_rates_of_a_turtlebot3(simulator):
    assert _params("real").sensors.lidar.profile().range_max == 3.5
    assert _params("real").topics.covariances == "real"
    sim = simulator("stage_1", **_profile("real"))
    seen = driven(sim, STANDSTILL, 1.0, everything(sim))
    expected = dict(scan=5, odom=30, joint_states=30, imu=200, bumper=0)
    assert {topic: sum(bool(due.of(topic)) for due in seen) for topic in expected} == expected


def test_the_real_profiles_encoders_count_ticks(simulator):
    sim = simulator("empty", **_profile("real"))
    driven(sim, Twist2D(0.1, 0.5), 1.0, ["joint_states", "odom"])
    angles = sim.sensors.joints.angles[0] / TICK
    assert angles == pytest.approx(np.round(angles), abs=1e-6) and angles.all()
    half = sim.fleet.wheels[0, 0] * TICK / 2.0 * 30.0  # [m/s] one tick of one wheel between two updates
    speed = sim.sensors.odometry.twists[0, 0] / half
    assert speed == pytest.approx(round(speed), abs=1e-6)
