"""Several robots in one simulator see, move and touch each other correctly."""

import math
from typing import Callable

import numpy as np
import pytest

from aro_robocop_goto_as.geometry import Pose2D, Twist2D
from aro_robocop_goto_as.simulation.simulator import Simulator

Make = Callable[..., Simulator]
LIDAR_RADIUS = 0.055  # [m] of the LDS, all that another Burger's scan sees of a Burger
DRIVES = [{"drive": "wheels"}, {"drive": "kinematic", "physics_rate": 60}]


@pytest.mark.parametrize("params", DRIVES)
def test_robots_see_each_others_scanners_but_not_their_own(simulator: Make, params: "dict[str, object]") -> None:
    sim = simulator("empty", Pose2D(0.0, 0.0, 0.0), Pose2D(1.0, 0.0, math.pi), **params)
    for robot in (0, 1):
        distances = sim.exact_distances(robot)
        assert distances.min() == pytest.approx(1.0 + 2 * 0.032 - LIDAR_RADIUS, abs=1e-6)
        assert np.isfinite(distances).sum() < 10


@pytest.mark.parametrize("params", DRIVES)
def test_command_moves_only_its_own_robot(simulator: Make, params: "dict[str, object]") -> None:
    sim = simulator("empty", Pose2D(0.0, 0.0), Pose2D(0.0, 1.0), **params)
    for _ in range(sim.config.rates.physics):
        sim.command(Twist2D(0.2, 0.0), robot=1)
        sim.step({})
    assert sim.world_from_footprint(0).x == pytest.approx(0.0, abs=1e-4)
    assert sim.world_from_footprint(1).x > 0.15


@pytest.mark.parametrize("params", DRIVES)
def test_two_robots_driving_towards_each_other_collide_and_stop(simulator: Make, params: "dict[str, object]") -> None:
    sim = simulator("empty", Pose2D(0.0, 0.0, 0.0), Pose2D(0.6, 0.0, math.pi), **params)
    for _ in range(4 * sim.config.rates.physics):
        sim.command(Twist2D(0.15, 0.0), robot=0)
        sim.command(Twist2D(0.15, 0.0), robot=1)
        sim.step({})
    assert sim.touching(0) and sim.touching(1)
    assert sim.world_from_footprint(1).x - sim.world_from_footprint(0).x > 0.05


def test_scan_noise_of_one_robot_does_not_depend_on_which_other_scans_are_subscribed(simulator: Make) -> None:
    def scan(wanted: "list[int]") -> "list[float]":
        sim = simulator("stage_1", Pose2D(0.0, 0.0), Pose2D(1.0, 0.0))
        for _ in range(24):
            seen = sim.step({"scan": wanted})
        assert seen is not None
        return list(seen.scans[1])

    assert scan([1]) == scan([0, 1])
