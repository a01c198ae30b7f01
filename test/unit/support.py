"""Shared by the unit tests: the package's folders, a ready simulator, an analytic ray cast."""

import os
from typing import Callable, Iterator, List

import numpy as np
import pytest
from hypothesis import settings

from aro_robocop_goto_as.geometry import Pose2D
from aro_robocop_goto_as.models import load_model
from aro_robocop_goto_as.params import SimParams
from aro_robocop_goto_as.robot import RobotModel
from aro_robocop_goto_as.simulator import RobotSpec, Simulator
from aro_robocop_goto_as.world import Box, Cylinder, World, find_world, load_world

# Always the same examples, and no limit on their time: a busy machine must not make a test fail.
settings.register_profile("robocop", derandomize=True, deadline=None)
settings.load_profile("robocop")

ORIGIN = Pose2D()
ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))


@pytest.fixture(scope="session")
def burger() -> RobotModel:
    return model_named("burger")


def model_named(name: str) -> RobotModel:
    return load_model(name, ROOT)


def world_named(name: str) -> World:
    return load_world(find_world(name, os.path.join(ROOT, "worlds")))


@pytest.fixture
def simulator() -> Iterator[Callable[..., Simulator]]:
    """Makes simulators, and closes them when the test is over."""
    made: List[Simulator] = []

    def make(world: str = "empty", *spawns: Pose2D, **params: object) -> Simulator:
        p = SimParams(**params)  # type: ignore[arg-type]
        robots = [RobotSpec(f"robot_{i}", model_named(p.model), spawn) for i, spawn in enumerate(spawns or [ORIGIN], 1)]
        made.append(Simulator(p, world_named(world), robots))
        return made[-1]

    yield make
    for it in made:
        it.close()


def analytic_distances(world: World, x: float, y: float, angles: np.ndarray, far: float) -> np.ndarray:
    """Exact distances (n,) [m] from a point along world angles (n,) [rad] to upright boxes and cylinders.

    Plane geometry only, nothing of it shared with the simulator: slabs for boxes, a quadratic for cylinders.
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
    with np.errstate(divide="ignore", invalid="ignore"):
        tx = np.sort(np.stack([(-half_x - ox) / dx, (half_x - ox) / dx]), axis=0)
        ty = np.sort(np.stack([(-half_y - oy) / dy, (half_y - oy) / dy]), axis=0)
    enter, leave = np.maximum(tx[0], ty[0]), np.minimum(tx[1], ty[1])
    return np.where((enter <= leave) & (enter > 0.0), enter, np.inf)


def _circle(ox: float, oy: float, dx: np.ndarray, dy: np.ndarray, radius: float) -> np.ndarray:
    b, c = ox * dx + oy * dy, ox * ox + oy * oy - radius * radius
    root = b * b - c
    near = -b - np.sqrt(np.maximum(root, 0.0))
    return np.where((root >= 0.0) & (near > 0.0), near, np.inf)
