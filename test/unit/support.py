"""Shared by the unit tests: the package's folders, a ready simulator, an analytic ray cast."""

import functools
import math
import os

import numpy as np
import pytest

from aro_robocop_goto_as.geometry import Pose2D
from aro_robocop_goto_as.robot.catalog import load_model
from aro_robocop_goto_as.robot.model import RobotSpec
from aro_robocop_goto_as.shapes import Box, Cylinder
from aro_robocop_goto_as.simulation.factory import make_simulator
from aro_robocop_goto_as.simulation.params import SimParams
from aro_robocop_goto_as.world.load import find_world, load_world

ORIGIN = Pose2D()
ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))


@pytest.fixture(scope="session")
def burger():
    return model_named("burger")


@functools.lru_cache(maxsize=None)
def model_named(name):
    return load_model(name, ROOT)


def world_named(name):
    return load_world(find_world(name, os.path.join(ROOT, "worlds")))


@pytest.fixture
def simulator():
    """Creates simulators, and closes them at the end of the test."""
    made = []

    def make(world="empty", *spawns, **params):
        p = SimParams.of(**params)
        model = model_named(p.robots.model)
        robots = [RobotSpec(f"robot_{i}", model, spawn) for i, spawn in enumerate(spawns or [ORIGIN], 1)]
        made.append(make_simulator(p, world_named(world), robots))
        return made[-1]

    yield make
    for one in made:
        one.close()


def everything(sim):
    """Subscriptions to all sensors of all robots."""
    return {topic: range(len(sim.robots)) for topic in sim.sensors.by_topic}


def drive(sim, twist, seconds, topics=(), robot=0):
    """Command a robot's velocity at each step for a time [s]; what is due of these sensors of all robots, at its step.

    Nothing moves but while what this returns is iterated over.
    """
    subscriptions = {topic: range(len(sim.robots)) for topic in topics}
    for _ in range(round(seconds * sim.rate)):
        sim.command(twist, robot)
        due = sim.advance(subscriptions)
        if due is not None:
            yield due


def driven(sim, twist, seconds, topics=(), robot=0):
    """What drive() yields, once all of it is over."""
    return list(drive(sim, twist, seconds, topics, robot))


def analytic_distances(world, x, y, angles, far):
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


def _slabs(ox, oy, dx, dy, half_x, half_y):
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        tx = np.sort(np.stack([(-half_x - ox) / dx, (half_x - ox) / dx]), axis=0)
        ty = np.sort(np.stack([(-half_y - oy) / dy, (half_y - oy) / dy]), axis=0)
    enter, leave = np.maximum(tx[0], ty[0]), np.minimum(tx[1], ty[1])
    return np.where((enter <= leave) & (enter > 0.0), enter, np.inf)


def _circle(ox, oy, dx, dy, radius):
    b, c = ox * dx + oy * dy, ox * ox + oy * oy - radius * radius
    root = b * b - c
    near = -b - np.sqrt(np.maximum(root, 0.0))
    return np.where((root >= 0.0) & (near > 0.0), near, np.inf)


def lean(sim, robot=0):
    """Angle [rad] between a robot's mast and the vertical."""
    x, y, _, _ = sim.engine.body(robot).world_from_base.orientation
    return 2.0 * math.asin(min(1.0, math.hypot(x, y)))
