"""Shared by the unit tests: the package's folders, a ready simulator, an analytic ray cast."""

import copy
import functools
import math
import os
from typing import Callable, Dict, Iterable, Iterator, List, Sequence

import numpy as np
import pytest

from aro_robocop_goto_as.geometry import Pose2D, Twist2D
from aro_robocop_goto_as.robot.catalog import load_model
from aro_robocop_goto_as.robot.model import RobotModel, RobotSpec
from aro_robocop_goto_as.shapes import Box, Cylinder
from aro_robocop_goto_as.sim_params import SimParams
from aro_robocop_goto_as.simulation.factory import make_simulator
from aro_robocop_goto_as.simulation.observations import Observations
from aro_robocop_goto_as.simulation.simulator import Simulator
from aro_robocop_goto_as.world.load import find_world, load_world
from aro_robocop_goto_as.world.model import World

ORIGIN = Pose2D()
ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))


@pytest.fixture(scope="session")
def burger() -> RobotModel:
    return model_named("burger")


@functools.lru_cache(maxsize=None)
def model_named(name: str) -> RobotModel:
    return load_model(name, ROOT)


def world_named(name: str) -> World:
    return load_world(find_world(name, os.path.join(ROOT, "worlds")))


@pytest.fixture
def simulator() -> Iterator[Callable[..., Simulator]]:
    """Creates simulators, and closes them at the end of the test."""
    made: List[Simulator] = []

    def make(world: str = "empty", *spawns: Pose2D, **params: object) -> Simulator:
        p = SimParams.of(**params)
        model = model_named(p.robots.model)
        robots = [RobotSpec(f"robot_{i}", model, spawn) for i, spawn in enumerate(spawns or [ORIGIN], 1)]
        made.append(make_simulator(p, world_named(world), robots))
        return made[-1]

    yield make
    for one in made:
        one.close()


SENSORS = ("scan", "odom", "tf", "joints", "imu", "ground_truth", "bumper", "camera")


def everything(robots: int) -> Dict[str, Sequence[int]]:
    """Subscriptions to all sensors of so many robots."""
    return {sensor: range(robots) for sensor in SENSORS}


def drive(
    sim: Simulator, twist: Twist2D, seconds: float, sensors: Iterable[str] = (), robot: int = 0
) -> List[Observations]:
    """Command a robot's velocity at each step for a time [s]; what was observed by these sensors of all robots."""
    subscriptions = {sensor: range(len(sim.robots)) for sensor in sensors}
    seen: List[Observations] = []
    for _ in range(round(seconds * sim.rate)):
        sim.command(twist, robot)
        observed = sim.step(subscriptions)
        seen += [] if observed is None else [kept(observed)]
    return seen


def kept(observed: Observations) -> Observations:
    """A copy of what the simulator changes in place with its next step, but for its fleet and its odometry."""
    kept = copy.copy(observed)
    kept.scan, kept.imu, kept.bumper, kept.camera = map(
        copy.copy, (observed.scan, observed.imu, observed.bumper, observed.camera)
    )
    kept.scan.ranges, kept.imu.samples = observed.scan.ranges.copy(), observed.imu.samples.copy()
    return kept


def analytic_distances(world: World, x: float, y: float, angles: np.ndarray, far: float) -> np.ndarray:
    """Exact distances (n,) [m] from a point along world angles (n,) [rad] to upright boxes and cylinders.

    Shares no code with the simulator: slabs for boxes, a quadratic equation for cylinders.
    """
    best = np.full(len(angles), np.inf)
    for obstacle in world.obstacles:
        px, py, _ = obstacle.pose.position
        yaw = obstacle.pose.on_plane().yaw
        c, s = np.cos(-yaw), np.sin(-yaw)
        ox, oy = c * (x - px) - s * (y - py), s * (x - px) + c * (y - py)
        dx, dy = np.cos(angles - yaw), np.sin(angles - yaw)
        if isinstance(obstacle.geometry, Box):
            hit = _slabs(ox, oy, dx, dy, obstacle.geometry.size[0] / 2, obstacle.geometry.size[1] / 2)
        elif isinstance(obstacle.geometry, Cylinder):
            hit = _circle(ox, oy, dx, dy, obstacle.geometry.radius)
        else:
            continue
        best = np.minimum(best, hit)
    return np.where(best <= far, best, np.inf)


def _slabs(ox: float, oy: float, dx: np.ndarray, dy: np.ndarray, half_x: float, half_y: float) -> np.ndarray:
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        tx = np.sort(np.stack([(-half_x - ox) / dx, (half_x - ox) / dx]), axis=0)
        ty = np.sort(np.stack([(-half_y - oy) / dy, (half_y - oy) / dy]), axis=0)
    enter, leave = np.maximum(tx[0], ty[0]), np.minimum(tx[1], ty[1])
    return np.where((enter <= leave) & (enter > 0.0), enter, np.inf)


def _circle(ox: float, oy: float, dx: np.ndarray, dy: np.ndarray, radius: float) -> np.ndarray:
    b, c = ox * dx + oy * dy, ox * ox + oy * oy - radius * radius
    root = b * b - c
    near = -b - np.sqrt(np.maximum(root, 0.0))
    return np.where((root >= 0.0) & (near > 0.0), near, np.inf)


def lean(sim: Simulator, robot: int = 0) -> float:
    """Angle [rad] between a robot's mast and the vertical."""
    x, y, _, _ = sim.engine.body(robot).world_from_base.orientation
    return 2.0 * math.asin(min(1.0, math.hypot(x, y)))
