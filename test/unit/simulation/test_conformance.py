"""What holds for every engine, model and world: one check, over all of their combinations."""

import math
from dataclasses import replace
from typing import Any, Callable, Dict, List, Tuple

import numpy as np
import pytest
from support import analytic_distances, everything, lean, model_named, world_named

from aro_robocop_goto_as.geometry import STANDSTILL, Twist2D, compose, wrap_angle
from aro_robocop_goto_as.simulation.simulator import Simulator

Make = Callable[..., Simulator]
ENGINES: Dict[str, Dict[str, Any]] = {
    "wheels": {"drive": "wheels"},
    "kinematic": {"drive": "kinematic", "physics_rate": 60, "imu_rate": 60},
}
MODELS = ["burger", "burger_rgbd", "waffle", "waffle_pi", "turtlebot2"]
WORLDS = ["empty", "world", "stage_4", "maze_1"]
CLOSED = ["world", "maze_1"]  # walls all around, and nothing that moves
RATES = {"scan": 10, "odom": 30, "tf": 30, "joints": 30, "ground_truth": 30, "bumper": 30}  # [Hz], by default
SECONDS = 1  # that a run takes
every_engine = pytest.mark.parametrize("engine", ENGINES)
every_model = pytest.mark.parametrize("model", MODELS)


def check_simulation(make: Make, engine: str, model: str, world: str) -> None:
    """Determinism, reset, scans, rates and stamps, the clock, limits, and contact with walls."""
    spawn = world_named(world).spawn

    def made(seed: int) -> Simulator:
        small = {"camera_width": 16, "camera_height": 12}  # rendered in no time
        return make(world, spawn, model=model, moving=True, seed=seed, **small, **ENGINES[engine])

    sim = made(1)
    first = _run(sim)
    assert first == _run(made(1)), "the same seed gives the same run"
    assert first != _run(made(2)), "another seed gives other noise"
    before = sim.stamp_ns
    sim.reset()
    assert sim.world_from_footprint() == pytest.approx(spawn, abs=1e-9) and sim.stamp_ns == before
    assert _run(sim) == first, "a reset starts noise and moving obstacles anew"
    _check_scan(sim, model)
    sim.reset()
    _check_rates(sim, everything(1))
    _check_limits(sim)
    if world in CLOSED:
        sim.reset()
        _check_contact(sim)


def _run(sim: Simulator) -> List[Tuple[str, bytes]]:
    """All that was measured in a drive along an arc and a stop."""
    seen: List[Tuple[str, bytes]] = []
    for step in range(SECONDS * sim.rate):
        sim.command(Twist2D(0.15, 0.4) if step < 0.7 * sim.rate else STANDSTILL)
        observed = sim.step(everything(1))
        if observed is not None:
            rows = {
                "odom": observed.odometry.poses,
                "ground_truth": observed.fleet.poses,
                "joints": observed.joints.angles,
                "imu": observed.imu.samples,
                "scan": observed.scan.ranges,
            }
            seen += [(name, array.tobytes()) for name, array in rows.items() if observed.of(name)]
            seen += [
                ("camera", image.depth.tobytes()) for image in observed.camera.images.values() if observed.of("camera")
            ]
    return seen


def _check_scan(sim: Simulator, model: str) -> None:
    """After one run, its distances are those of an analytic ray cast to where obstacles are by then."""
    obstacles = tuple(replace(obstacle, pose=obstacle.at(SECONDS)) for obstacle in sim.world.obstacles)
    x, y, yaw = compose(sim.world_from_footprint(), model_named(model).base_from_scan.on_plane())
    angles = yaw + np.arange(360) * sim.lidar.spec.increment
    expected = analytic_distances(replace(sim.world, obstacles=obstacles), x, y, angles, 10.0)
    agree = np.isclose(sim.exact_distances(), expected, rtol=0.0, atol=1e-3)
    assert agree.mean() > 0.98, "all but grazing beams"


def _check_rates(sim: Simulator, subscriptions: Dict[str, Any]) -> None:
    start, counts, ticks, stamps = sim.stamp_ns, dict.fromkeys(RATES, 0), [0, 0], []
    for _ in range(SECONDS * sim.rate):
        observed = sim.step(subscriptions)
        if observed is not None:
            stamps.append(observed.stamp_ns)
            counts = {name: count + len(observed.of(name)) for name, count in counts.items()}
            ticks = [ticks[0] + observed.due.clock, ticks[1] + observed.due.control]
            assert observed.stamp_ns % (10**9 // RATES["scan"]) == 0 or not observed.of("scan")
    assert counts == {name: SECONDS * rate for name, rate in RATES.items()}
    assert ticks == [SECONDS * 60, SECONDS * 10]
    assert stamps == sorted(set(stamps)) and sim.stamp_ns - start == SECONDS * 10**9


def _check_limits(sim: Simulator) -> None:
    """Asked for too much, the robot accelerates to its limits within its limits."""
    limits, dt = sim.fleet.limits[0], 1.0 / sim.rate
    speeds = [0.0]
    for _ in range(round(1.5 * sim.rate)):
        sim.command(Twist2D(0.0, 99.0))
        sim.step({})
        speeds.append(float(sim.fleet.velocities[0, 1]))
    assert max(np.diff(speeds)) <= limits.max_dw * dt + 1e-9
    assert max(speeds) == pytest.approx(min(limits.max_w, 1.5 * limits.max_dw), rel=0.01)
    assert lean(sim) < math.radians(3.0)


def _check_contact(sim: Simulator) -> None:
    """The robot stops upright at a wall, wheels turning, and can back out."""
    _drive(sim, Twist2D(0.2), 30.0, sim.touching)
    assert sim.touching(), "there is a wall ahead"
    stuck = sim.world_from_footprint()
    odom = _odom(sim)
    _drive(sim, Twist2D(0.2), 2.0)
    at_wall = sim.world_from_footprint()
    assert math.dist(at_wall[:2], stuck[:2]) < 0.1 < math.dist(_odom(sim)[:2], odom[:2])
    assert sim.exact_distances().min() > 0.0 and lean(sim) < math.radians(3.0)
    assert _bumper(sim)
    _drive(sim, Twist2D(-0.2), 2.0)
    assert math.dist(sim.world_from_footprint()[:2], at_wall[:2]) > 0.2
    assert not sim.touching() and not _bumper(sim)


def _drive(sim: Simulator, twist: Twist2D, seconds: float, until: Callable[[], bool] = lambda: False) -> None:
    """Command a velocity ten times a second, until a condition holds or for a time [s]."""
    for _ in range(round(10 * seconds)):
        if until():
            return
        sim.command(twist)
        end = sim.steps + sim.rate // 10
        while sim.steps < end:
            sim.advance({}, end - sim.steps)


def _bumper(sim: Simulator) -> bool:
    """What the bumper says next."""
    while True:
        observed = sim.step({"bumper": [0]})
        if observed is not None and observed.bumper.touching and observed.of("bumper"):
            return observed.bumper.touching[0]


def _odom(sim: Simulator) -> "List[float]":
    """The last pose of odometry."""
    return sim.observed.odometry.poses[0].tolist()


@every_engine
@every_model
@pytest.mark.parametrize("world", WORLDS)
def test_simulation_of_any_engine_model_and_world_conforms(
    simulator: Make, engine: str, model: str, world: str
) -> None:
    check_simulation(simulator, engine, model, world)


@every_model
@pytest.mark.parametrize("twist", [Twist2D(0.2), Twist2D(-0.2), Twist2D(0.0, 1.0), Twist2D(0.0, -1.8)])
def test_two_metres_and_a_full_turn_are_accurate_and_a_robot_does_not_drift(
    simulator: Make, model: str, twist: Twist2D
) -> None:
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
def test_robot_stays_upright_at_its_highest_speeds(simulator: Make, model: str) -> None:
    sim = simulator(model=model)
    limits, leans = sim.fleet.limits[0], []
    for twist in (Twist2D(limits.max_v), STANDSTILL, Twist2D(0.0, limits.max_w)):
        for _ in range(30):
            _drive(sim, twist, 0.1)
            leans.append(lean(sim))
    assert max(leans) < math.radians(3.0)


@every_engine
def test_engine_without_slip_drives_an_exact_arc(simulator: Make, engine: str) -> None:
    sim = simulator(max_linear_acceleration=1e3, max_angular_acceleration=1e3, **ENGINES[engine])
    _drive(sim, Twist2D(0.15, 0.4), 5.0)
    pose, radius = sim.world_from_footprint(), 0.15 / 0.4
    assert math.dist(pose[:2], (radius * math.sin(2.0), radius * (1.0 - math.cos(2.0)))) < 0.01
    assert abs(pose.yaw - 2.0) < math.radians(1.0)
