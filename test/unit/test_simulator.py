"""The simulator, compared with an ideal differential drive and an analytic ray cast; rates, seeds and resets."""

import math
from typing import Callable

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from support import analytic_distances, everything, lean, world_named

from aro_robocop_goto_as.errors import CommandError
from aro_robocop_goto_as.geometry import STANDSTILL, Pose2D, Twist2D, compose, wrap_angle
from aro_robocop_goto_as.simulation.clock import due
from aro_robocop_goto_as.simulation.simulator import Simulator

Make = Callable[..., Simulator]
NOTHING: "dict[str, list[int]]" = {}


def _drive(sim: Simulator, twist: Twist2D, seconds: float) -> None:
    """Command a velocity for a time, then stop and come to rest."""
    for _ in range(int(round(seconds * sim.config.rates.physics))):
        sim.command(twist)
        sim.step(NOTHING)
    for _ in range(sim.config.rates.physics):
        sim.command(STANDSTILL)
        sim.step(NOTHING)


@pytest.mark.parametrize("v", [0.2, -0.2])
def test_driving_two_metres_is_accurate_to_one_percent(simulator: Make, v: float) -> None:
    sim = simulator()
    _drive(sim, Twist2D(v, 0.0), 10.0)
    pose = sim.world_from_footprint()
    assert math.hypot(pose.x - 10.0 * v, pose.y) < 0.02
    assert abs(pose.yaw) < math.radians(2.0)


@pytest.mark.parametrize("w", [1.0, -2.5])
def test_full_turn_in_place_is_accurate_to_two_degrees(simulator: Make, w: float) -> None:
    sim = simulator()
    _drive(sim, Twist2D(0.0, w), abs(2.0 * math.pi / w))
    pose = sim.world_from_footprint()
    assert abs(pose.yaw) < math.radians(2.0)
    assert math.hypot(pose.x, pose.y) < 0.01


@pytest.mark.parametrize("before", [0.0, 3.0])
def test_a_robot_without_a_command_does_not_drift(simulator: Make, before: float) -> None:
    sim = simulator()
    if before:
        _drive(sim, Twist2D(0.15, 0.4), before)
    start = sim.world_from_footprint()
    for _ in range(60 * 240):
        sim.step(NOTHING)
    end = sim.world_from_footprint()
    assert math.hypot(end.x - start.x, end.y - start.y) < 1e-3
    assert abs(wrap_angle(end.yaw - start.yaw)) < math.radians(0.1)


def test_robot_stops_upright_at_a_wall_and_can_back_out(simulator: Make) -> None:
    sim = simulator("stage_1", Pose2D(1.5, 0.0))
    _drive(sim, Twist2D(0.22, 0.0), 5.0)
    stuck = sim.world_from_footprint()
    assert stuck.x < 1.85 - 0.033, "the robot is in the wall"
    assert sim.touching()
    assert lean(sim) < math.radians(3.0)
    _drive(sim, Twist2D(-0.2, 0.0), 3.0)
    assert sim.world_from_footprint().x < stuck.x - 0.4
    assert not sim.touching()


@pytest.mark.parametrize("world", ["stage_4", "world", "maze_1"])
def test_scan_and_physics_agree_with_an_analytic_ray_cast(simulator: Make, world: str) -> None:
    description = world_named(world)
    sim = simulator(world, description.spawn, scan_noise=0.0)
    rng = np.random.default_rng(7)
    half = max(abs(value) for obstacle in description.obstacles for value in obstacle.pose.position[:2])
    tried = 0
    while tried < 10:
        x, y, yaw = rng.uniform(-half, half), rng.uniform(-half, half), rng.uniform(-math.pi, math.pi)
        ring = analytic_distances(description, x, y, np.linspace(0, 2 * math.pi, 90), 50.0)
        if not (0.3 < ring.min() and np.isfinite(ring).all()):  # too close to an obstacle, or outside the walls
            continue
        sim.place(Pose2D(x, y, yaw))
        _drive(sim, Twist2D(0.1, rng.uniform(-1.0, 1.0)), 1.0)
        pose = sim.world_from_footprint()
        scan_x, scan_y = pose.x - 0.032 * math.cos(pose.yaw), pose.y - 0.032 * math.sin(pose.yaw)
        angles = pose.yaw + np.arange(360) * sim.lidar.spec.increment
        expected = analytic_distances(description, scan_x, scan_y, angles, 10.0)
        assert np.abs(sim.exact_distances() - expected)[np.isfinite(expected)].max() < 0.002
        assert (np.isfinite(sim.exact_distances()) == np.isfinite(expected)).all()
        tried += 1


def test_observations_of_a_step_carry_its_stamp_and_rates_are_exact_over_one_second(simulator: Make) -> None:
    sim = simulator("stage_1")
    seen = [it for it in (sim.step(everything(len(sim.robots))) for _ in range(240)) if it is not None]
    counts = {
        name: sum(getattr(it, name) not in (None, {}) for it in seen)
        for name in ("scans", "odometry", "joints", "imus", "ground_truth", "bumpers", "magnetic_fields")
    }
    assert counts == {
        "scans": 10,
        "odometry": 30,
        "joints": 30,
        "imus": 200,
        "ground_truth": 30,
        "bumpers": 30,
        "magnetic_fields": 0,
    }
    assert sum(it.clock for it in seen) == 60
    assert seen[-1].stamp_ns == 1000000000
    assert all(it.stamp_ns % 100000000 == 0 for it in seen if it.scans)


@given(st.integers(1, 240), st.integers(0, 10**6))
def test_rate_that_does_not_divide_the_physics_rate_has_an_exact_mean(rate: int, first: int) -> None:
    assert sum(due(step, rate, 240) for step in range(first + 1, first + 241)) == rate


def test_same_seed_gives_the_same_run_whatever_is_subscribed(simulator: Make) -> None:
    def run(seed: int, listening: bool) -> "tuple[list[float], Pose2D]":
        sim = simulator("stage_2", seed=seed)
        for step in range(480):
            sim.command(Twist2D(0.2, 0.3))
            seen = sim.step(everything(len(sim.robots)) if listening or step == 479 else NOTHING)
        assert seen is not None
        return list(seen.scans[0]), sim.world_from_footprint()

    assert run(1, True) == run(1, False)
    assert run(1, True)[0] != run(2, True)[0]
    assert run(1, True)[1] == run(2, True)[1]


def test_reset_returns_the_robot_to_its_spawn_while_time_continues(simulator: Make) -> None:
    sim = simulator("stage_4", Pose2D(-0.7, 0.0))
    _drive(sim, Twist2D(0.2, 0.5), 2.0)
    before = sim.stamp_ns
    sim.reset()
    observed = [sim.step(everything(len(sim.robots))) for _ in range(8)][-1]
    truth = sim.world_from_footprint()
    assert observed is not None and observed.stamp_ns > before
    assert (truth.x, truth.y, truth.yaw) == pytest.approx((-0.7, 0.0, 0.0), abs=1e-4)
    assert observed.odometry is not None
    assert observed.odometry[0].odom_from_footprint.x == pytest.approx(0.0, abs=1e-4)


def test_placing_the_robot_changes_map_from_odom_instead_of_odometry(simulator: Make) -> None:
    sim = simulator("stage_4", Pose2D(-0.7, 0.0))
    _drive(sim, Twist2D(0.2, 0.0), 1.0)
    for _ in range(8):
        sim.step(NOTHING)
    sim.place(Pose2D(1.0, -1.0, 1.0))
    assert sim.map_from_odom().yaw == pytest.approx(1.0, abs=0.01)
    assert sim.map_from_odom().x == pytest.approx(1.0 - 0.2 * math.cos(1.0), abs=0.01)


@pytest.mark.parametrize(
    "params, accuracy", [({}, 1e-9), ({"encoder_tick": 0.0015}, 1e-3), ({"odom_slip": 0.05}, 0.012)]
)
def test_placing_the_robot_between_odometry_updates_loses_no_travel(
    simulator: Make, params: "dict[str, float]", accuracy: float
) -> None:
    sim = simulator("empty", drive="kinematic", max_linear_acceleration=1e3, odom_rate=10, **params)
    for _ in range(240 + 23):  # 23 of the 24 steps between two updates
        sim.command(Twist2D(0.2, 0.0))
        sim.step({"odom": [0]})
    sim.place(Pose2D(1.0, -1.0, 1.0))
    for _ in range(24):
        seen = sim.step({"odom": [0]})
        if seen is not None and seen.odometry:
            odom = seen.odometry[0].odom_from_footprint
    in_world = compose(sim.map_from_odom(), odom)
    assert (in_world.x, in_world.y, in_world.yaw) == pytest.approx((1.0, -1.0, 1.0), abs=accuracy)


def test_odometry_of_the_world_is_the_true_pose_from_the_start(simulator: Make) -> None:
    sim = simulator("stage_4", Pose2D(-0.7, 0.0, 0.5), odom_source="world", odom_slip=0.1)
    _drive(sim, Twist2D(0.2, 0.3), 1.0)
    seen = [it for it in (sim.step({"odom": [0], "ground_truth": [0]}) for _ in range(8)) if it is not None]
    (odometry,) = [it.odometry[0] for it in seen if it.odometry]
    (truth,) = [it.ground_truth[0] for it in seen if it.ground_truth]
    assert odometry.odom_from_footprint == truth.world_from_footprint
    assert odometry.twist == truth.twist
    sim.place(Pose2D(1.0, -1.0, 1.0))
    assert sim.map_from_odom() == Pose2D()


def test_encoders_and_ground_truth_differ_when_the_wheels_slip(simulator: Make) -> None:
    sim = simulator("stage_1", Pose2D(1.7, 0.0))
    for _ in range(480):
        sim.command(Twist2D(0.22, 0.0))
        seen = sim.step({"odom": [0]})
    assert seen is not None and seen.odometry is not None
    travelled = sim.world_from_footprint().x - 1.7
    assert seen.odometry[0].odom_from_footprint.x > travelled + 0.05


def test_invalid_command_leaves_the_previous_one_in_force(simulator: Make) -> None:
    sim = simulator()
    sim.command(Twist2D(0.2, 0.0))
    with pytest.raises(CommandError):
        sim.command(Twist2D(math.nan, 0.0))
    for _ in range(100):
        sim.step(NOTHING)
    assert sim.velocity().v == pytest.approx(0.2, rel=0.02)


def test_reset_restarts_the_noise_sequence(simulator: Make) -> None:
    sim = simulator("stage_2")

    def first_scan() -> "list[float]":
        for _ in range(24):
            seen = sim.step(everything(len(sim.robots)))
        assert seen is not None
        return list(seen.scans[0])

    once = first_scan()
    sim.reset()
    again = first_scan()
    sim.reset(seed=9)
    other = first_scan()
    assert once == again and once != other


def test_reset_sets_time_back_only_on_request(simulator: Make) -> None:
    sim = simulator("empty")
    for _ in range(10):
        sim.step(NOTHING)
    sim.reset()
    assert sim.steps == 10
    sim.reset(restart_time=True)
    assert sim.stamp_ns == 0
