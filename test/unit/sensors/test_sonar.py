"""The sonar: what it measures beside the lidar, in its own place on the robot."""

import math
from dataclasses import replace
from typing import Callable

import pytest
from support import driven, model_named

from aro_robocop_goto_as.geometry import STANDSTILL, Pose2D, Pose3D
from aro_robocop_goto_as.sensors.sonar import HEIGHT, SONAR, mount
from aro_robocop_goto_as.shapes import Box
from aro_robocop_goto_as.simulation.simulator import Simulator
from aro_robocop_goto_as.world.model import Obstacle

Make = Callable[..., Simulator]
EXACT = {"sonar": True, "sonar_noise": 0.0, "drive": "kinematic"}
FRONT = 0.038  # [m] of a Burger, from its axle


def _with_board(sim: Simulator, x: float, height: float, y: float = 0.0) -> Simulator:
    """With a board across the way, its face at x [m], its top at a height [m]."""
    board = Obstacle("board/link", Pose3D((x + 0.05, y, height / 2.0)), Box((0.1, 0.4, height)))
    sim.change_world(replace(sim.world, obstacles=(*sim.world.obstacles, board)))
    return sim


def _range(sim: Simulator, robot: int = 0) -> float:
    """What a robot's sonar says next."""
    while not any(due.of(SONAR) for due in driven(sim, STANDSTILL, 1.0 / sim.rate, [SONAR])):
        pass
    return float(sim.sensors.sonar.ranges[robot, 0])


def test_a_board_that_the_lidar_looks_over_is_measured(simulator: Make) -> None:
    sim = _with_board(simulator(**EXACT), 1.0, 0.1)
    assert _range(sim) == pytest.approx(1.0 - FRONT)
    assert math.isinf(sim.exact_distances()[0])


def test_a_board_below_the_sonar_is_not_measured(simulator: Make) -> None:
    assert _range(_with_board(simulator(**EXACT), 1.0, HEIGHT - 0.01)) == math.inf


def test_the_nearest_return_within_the_cone_counts(simulator: Make) -> None:
    sim = _with_board(simulator(**EXACT), 2.0, 0.1, y=0.4)  # its edge is 0.2 m to the left; the cone reaches 0.26 m
    assert _range(sim) == pytest.approx((2.0 - FRONT) / math.cos(math.radians(7.5)), abs=1e-3)


def test_another_robot_is_measured(simulator: Make) -> None:
    sim = simulator("empty", Pose2D(), Pose2D(1.0, 0.0), **EXACT)
    assert 0.8 < _range(sim) < 1.0 - FRONT
    assert _range(sim, 1) == math.inf, "nothing is ahead of the second robot, and none sees itself"


@pytest.mark.parametrize("x, expected", [(FRONT + 0.019, -math.inf), (FRONT + 0.021, 0.021), (FRONT + 4.01, math.inf)])
def test_what_is_too_near_or_too_far_is_reported_as_rep_117_asks(simulator: Make, x: float, expected: float) -> None:
    assert _range(_with_board(simulator(**EXACT), x, 0.1)) == pytest.approx(expected)


def test_its_noise_is_repeatable(simulator: Make) -> None:
    def run(seed: int) -> float:
        return _range(_with_board(simulator(sonar=True, drive="kinematic", seed=seed), 1.0, 0.1))

    assert run(1) == run(1) != run(2)
    assert run(1) == pytest.approx(1.0 - FRONT, abs=0.01)


def test_without_it_no_rate_is_demanded_and_nothing_is_due(simulator: Make) -> None:
    others = ("clock", "control", "scan", "odom", "camera", "joint_state", "imu", "ground_truth", "bumper")
    sim = simulator(physics_rate=12, **{f"{name}_rate": 12 for name in others})
    assert not any(due.of(SONAR) for due in driven(sim, STANDSTILL, 1.0, [SONAR]))


@pytest.mark.parametrize("model, front", [("burger", FRONT), ("waffle", 0.069), ("turtlebot2", 0.178)])
def test_it_is_at_the_front_of_each_model_low_above_the_floor(model: str, front: float) -> None:
    robot = model_named(model)
    assert mount(robot).position[0] == pytest.approx(front, abs=1e-3)
    assert robot.height_of(mount(robot)) == pytest.approx(HEIGHT)
