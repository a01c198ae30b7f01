"""What holds for every engine, model and world: one test a contract, over all of their combinations."""

import itertools
import math
from dataclasses import replace

import numpy as np
import pytest
from support import analytic_distances, everything, lean, model_named, world_named

from aro_robocop_goto_as.geometry import STANDSTILL, Twist2D, compose, wrap_angle

ENGINES = {
    "wheels": {"drive": "wheels"},
    "kinematic": {"drive": "kinematic", "physics_rate": 60, "imu_rate": 60},
}
MODELS = ["burger", "burger_rgbd", "waffle", "waffle_pi", "turtlebot2"]
WORLDS = ["empty", "world", "stage_4", "maze_1"]
CLOSED = ["world", "maze_1"]  # walls all around, and nothing that moves
RATES = {"scan": 10, "odom": 30, "joint_states": 30, "ground_truth_odom": 30, "bumper": 30}  # [Hz], by default
SECONDS = 1  # that a run takes
every_engine = pytest.mark.parametrize("engine", ENGINES)
every_model = pytest.mark.parametrize("model", MODELS)


def every_combination(test):
    """Run a test for every engine, model and world; without --all for a Burger in each, and for each model in one."""
    cases = [
        pytest.param(model, world, marks=() if model == "burger" or world == "stage_4" else pytest.mark.slow)
        for model, world in itertools.product(MODELS, WORLDS)
    ]
    return every_engine(pytest.mark.parametrize("model, world", cases)(test))


@pytest.fixture
def make(simulator, engine, model, world):
    """Makes a simulator of a robot at the world's spawn, with a seed."""

    def made(seed=1):
        params = dict(moving=True, seed=seed, camera_width=16, camera_height=12, **ENGINES[engine])  # small images
        return simulator(world, world_named(world).spawn, model=model, **params)

    return made


def _run(sim):
    """All that was measured in a drive along an arc and a stop."""
    seen = []
    rows = {
        "odom": sim.sensors.odometry.poses,
        "ground_truth_odom": sim.sensors.ground_truth.poses,
        "joint_states": sim.sensors.joints.angles,
        "imu": sim.sensors.imu.samples,
        "scan": sim.sensors.lidar.ranges,
    }
    for step in range(SECONDS * sim.rate):
        sim.command(Twist2D(0.15, 0.4) if step < 0.7 * sim.rate else STANDSTILL)
        due = sim.advance(everything(sim))
        if due is not None:
            seen += [(topic, array.tobytes()) for topic, array in rows.items() if due.of(topic)]
            images = sim.sensors.camera.images.values() if due.of("camera") else ()
            seen += [("camera", image.depth.tobytes()) for image in images]
    return seen


@every_combination
def test_the_same_seed_gives_the_same_run_and_another_seed_other_noise(make):
    first = _run(make())
    assert first == _run(make())
    assert first != _run(make(2))


@every_combination
def test_reset_starts_noise_and_moving_obstacles_anew_at_the_spawn_while_time_goes_on(make, world):
    sim = make()
    first, before = _run(sim), sim.stamp_ns
    sim.reset()
    assert sim.world_from_footprint() == pytest.approx(world_named(world).spawn, abs=1e-9) and sim.stamp_ns == before
    assert _run(sim) == first


@every_combination
def test_distances_are_those_of_an_analytic_ray_cast_to_where_obstacles_are_by_then(make, model):
    sim = make()
    _run(sim)
    obstacles = tuple(replace(obstacle, pose=obstacle.at(SECONDS)) for obstacle in sim.world.obstacles)
    x, y, yaw = compose(sim.world_from_footprint(), model_named(model).base_from_scan.on_plane())
    angles = yaw + np.arange(360) * sim.sensors.lidar.profile.increment
    expected = analytic_distances(replace(sim.world, obstacles=obstacles), x, y, angles, 10.0)
    agree = np.isclose(sim.exact_distances(), expected, rtol=0.0, atol=1e-3)
    assert agree.mean() > 0.98, "all but grazing beams"


@every_combination
def test_each_sensor_keeps_its_rate_and_stamps_are_those_of_its_period(make):
    sim = make()
    subscriptions, counts, ticks, stamps = everything(sim), dict.fromkeys(RATES, 0), [0, 0], []
    for _ in range(SECONDS * sim.rate):
        due = sim.advance(subscriptions)
        if due is not None:
            stamps.append(sim.stamp_ns)
            counts = {topic: count + len(due.of(topic)) for topic, count in counts.items()}
            ticks = [ticks[0] + due.clock, ticks[1] + due.control]
            assert sim.stamp_ns % (10**9 // RATES["scan"]) == 0 or not due.of("scan")
    assert counts == {topic: SECONDS * rate for topic, rate in RATES.items()}
    assert ticks == [SECONDS * 60, SECONDS * 10]
    assert stamps == sorted(set(stamps)) and sim.stamp_ns == SECONDS * 10**9


@every_combination
def test_robot_that_is_asked_for_too_much_accelerates_to_its_limits_within_its_limits(make):
    sim = make()
    limits, dt = sim.fleet.limits[0], 1.0 / sim.rate
    speeds = [0.0]
    for _ in range(round(1.5 * sim.rate)):
        sim.command(Twist2D(0.0, 99.0))
        sim.advance({})
        speeds.append(float(sim.fleet.velocities[0, 1]))
    assert max(np.diff(speeds)) <= limits.max_dw * dt + 1e-9
    assert max(speeds) == pytest.approx(min(limits.max_w, 1.5 * limits.max_dw), rel=0.01)
    assert lean(sim) < math.radians(3.0)


@every_engine
@every_model
@pytest.mark.parametrize("world", CLOSED)
def test_robot_stops_upright_at_a_wall_with_turning_wheels_and_can_back_out(make):
    sim = make()
    _drive(sim, Twist2D(0.2), 30.0, sim.touching)
    assert sim.touching(), "there is a wall ahead"
    stuck, odom = sim.world_from_footprint(), _odom(sim)
    _drive(sim, Twist2D(0.2), 2.0)
    at_wall = sim.world_from_footprint()
    assert math.dist(at_wall[:2], stuck[:2]) < 0.1 < math.dist(_odom(sim)[:2], odom[:2])
    assert sim.exact_distances().min() > 0.0 and lean(sim) < math.radians(3.0)
    assert _bumper(sim)
    _drive(sim, Twist2D(-0.2), 2.0)
    assert math.dist(sim.world_from_footprint()[:2], at_wall[:2]) > 0.2
    assert not sim.touching() and not _bumper(sim)


def _drive(sim, twist, seconds, until=lambda: False):
    """Command a velocity ten times a second, until a condition holds or for a time [s]."""
    for _ in range(round(10 * seconds)):
        if until():
            return
        sim.command(twist)
        end = sim.steps + sim.rate // 10
        while sim.steps < end:
            sim.advance({}, end - sim.steps)


def _bumper(sim):
    """What the bumper says next."""
    while True:
        due = sim.advance({"bumper": [0]})
        if due is not None and due.of("bumper"):
            return sim.sensors.bumper.touching[0]


def _odom(sim):
    """The last pose of odometry."""
    return sim.sensors.odometry.poses[0].tolist()


@every_model
@pytest.mark.parametrize("twist", [Twist2D(0.2), Twist2D(-0.2), Twist2D(0.0, 1.0), Twist2D(0.0, -1.8)])
def test_two_metres_and_a_full_turn_are_accurate_and_a_robot_does_not_drift(simulator, model, twist):
    sim = simulator(model=model)
    for _ in range(round((2.0 / abs(twist.v) if twist.v else 2.0 * math.pi / abs(twist.w)) * sim.rate)):
        sim.command(twist)
        sim.advance({}, 1)
    _drive(sim, STANDSTILL, 1.0)
    pose = sim.world_from_footprint()
    assert math.hypot(pose.x - twist.v * 10.0, pose.y) < (0.02 if twist.v else 0.01)
    assert abs(wrap_angle(pose.yaw)) < math.radians(2.0)
    _drive(sim, STANDSTILL, 10.0)
    later = sim.world_from_footprint()
    assert math.dist(later[:2], pose[:2]) < 2e-4 and abs(later.yaw - pose.yaw) < math.radians(0.02)


@every_model
def test_robot_stays_upright_at_its_highest_speeds(simulator, model):
    sim = simulator(model=model)
    limits, leans = sim.fleet.limits[0], []
    for twist in (Twist2D(limits.max_v), STANDSTILL, Twist2D(0.0, limits.max_w)):
        for _ in range(30):
            _drive(sim, twist, 0.1)
            leans.append(lean(sim))
    assert max(leans) < math.radians(3.0)


@every_engine
def test_engine_without_slip_drives_an_exact_arc(simulator, engine):
    sim = simulator(max_linear_acceleration=1e3, max_angular_acceleration=1e3, **ENGINES[engine])
    _drive(sim, Twist2D(0.15, 0.4), 5.0)
    pose, radius = sim.world_from_footprint(), 0.15 / 0.4
    assert math.dist(pose[:2], (radius * math.sin(2.0), radius * (1.0 - math.cos(2.0)))) < 0.01
    assert abs(pose.yaw - 2.0) < math.radians(1.0)
