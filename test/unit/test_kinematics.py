"""The ideal drive: exact where it is free, and never through anything."""

import math
from typing import Callable

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from support import world_named

from aro_robocop_goto_as.drive import wheel_speeds
from aro_robocop_goto_as.geometry import Pose2D, Pose3D, Twist2D
from aro_robocop_goto_as.kinematics import Kinematics
from aro_robocop_goto_as.robot import RobotModel
from aro_robocop_goto_as.simulator import Simulator
from aro_robocop_goto_as.world import Box, Cylinder, Obstacle, World

RADIUS = 0.105
WALL = World("wall", (Obstacle("wall", Pose3D((2.0, 0.0, 0.25)), Box((0.02, 4.0, 0.5))),), Pose2D(), (), "")
POST = World("post", (Obstacle("post", Pose3D((1.0, 0.0, 0.25)), Cylinder(0.1, 0.5)),), Pose2D(), (), "")


def _kinematics(model: RobotModel, world: World, *spawns: Pose2D, rate: int = 30) -> Kinematics:
    it = Kinematics(world, rate, RADIUS)
    for spawn in spawns:
        it.add_robot(model, spawn)
    return it


def _drive(it: Kinematics, *velocities: "tuple[float, float]") -> None:
    for robot, (v, w) in enumerate(velocities):
        it.drive(robot, wheel_speeds(Twist2D(v, w), 0.033, 0.16))


@given(st.floats(-0.3, 0.3), st.floats(-3.0, 3.0), st.integers(1, 100))
def test_without_obstacles_it_is_the_ideal_arc(burger: RobotModel, v: float, w: float, steps: int) -> None:
    it = _kinematics(burger, world_named("empty"), Pose2D())
    _drive(it, (v, w))
    for _ in range(steps):
        it.step()
    t = steps / 30.0
    x, y = (v / w * math.sin(w * t), v / w * (1.0 - math.cos(w * t))) if abs(w) > 1e-2 else (v * t, 0.0)
    tolerance = 1e-9 if abs(w) > 1e-2 else 0.05
    assert (it.state(0).world_from_base.x, it.state(0).world_from_base.y) == pytest.approx((x, y), abs=tolerance)


@pytest.mark.parametrize("v", [0.1, 1.0, 30.0, 1e4])
@pytest.mark.parametrize("rate", [30, 100])
def test_a_wall_stops_it_at_any_speed_with_its_rim_at_the_wall(burger: RobotModel, v: float, rate: int) -> None:
    it = _kinematics(burger, WALL, Pose2D(), rate=rate)
    _drive(it, (v, 0.0))
    for _ in range(int(2.5 / v * rate) + 2):
        it.step()
    assert it.state(0).world_from_base.x == pytest.approx(2.0 - 0.01 - RADIUS, abs=1e-4)
    assert it.touching(0) and it.state(0).twist.v == pytest.approx(0.0, abs=1e-3)


def test_it_can_back_out_and_turn_at_a_wall(burger: RobotModel) -> None:
    it = _kinematics(burger, WALL, Pose2D(1.5, 0.0))
    _drive(it, (1.0, 0.0))
    for _ in range(60):
        it.step()
    _drive(it, (0.0, 1.0))
    for _ in range(30):
        it.step()
    assert it.state(0).world_from_base.yaw == pytest.approx(1.0)
    _drive(it, (-1.0, 0.0))
    for _ in range(30):
        it.step()
    assert it.state(0).world_from_base.x == pytest.approx(2.0 - 0.01 - RADIUS - math.cos(1.0), abs=1e-3)


@given(st.floats(-math.pi, math.pi), st.floats(0.01, 300.0), st.floats(-5.0, 5.0))
def test_nothing_is_ever_entered(burger: RobotModel, yaw: float, v: float, w: float) -> None:
    world = world_named("stage_2")
    it = _kinematics(burger, world, Pose2D(0.0, 0.0, yaw))
    _drive(it, (v, w))
    for _ in range(40):
        it.step()
        x, y = it.state(0).world_from_base.x, it.state(0).world_from_base.y
        assert max(abs(x), abs(y)) < 1.85 - RADIUS + 1e-9
        for cx in (-0.6, 0.6):
            for cy in (-0.6, 0.6):
                assert math.hypot(x - cx, y - cy) > 0.15 + RADIUS - 1e-9


@given(st.lists(st.tuples(st.floats(-0.5, 0.5), st.floats(-3, 3)), min_size=4, max_size=4))
def test_robots_bump_into_each_other_and_never_overlap(
        burger: RobotModel, velocities: "list[tuple[float, float]]") -> None:
    spawns = [Pose2D(0.0, 0.0, 0.0), Pose2D(0.4, 0.0, math.pi), Pose2D(0.0, 0.4, -1.5), Pose2D(0.4, 0.4, -2.3)]
    it = _kinematics(burger, POST, *spawns)
    _drive(it, *velocities)
    for _ in range(60):
        it.step()
        poses = [it.state(robot).world_from_base for robot in range(4)]
        places = np.array([(pose.x, pose.y) for pose in poses])
        apart = np.hypot(*(places[:, None] - places[None]).transpose(2, 0, 1)) + np.eye(4)
        assert apart.min() > 2.0 * RADIUS - 1e-9


def test_wheels_that_slip_at_a_wall_count_on(simulator: Callable[..., Simulator]) -> None:
    sim = simulator("stage_1", Pose2D(1.6, 0.0), drive="kinematic", physics_rate=60)
    for _ in range(120):
        sim.command(Twist2D(0.22, 0.0))
        seen = sim.step({})
    assert seen is not None and seen.odometry is not None
    assert sim.touching()
    assert seen.odometry[0].odom_from_base.x > sim.world_from_base().x - 1.6 + 0.1


@pytest.mark.parametrize("drive", ["kinematic", "wheels"])
def test_a_robot_that_is_set_down_in_a_wall_touches_it_at_once(simulator: Callable[..., Simulator], drive: str) -> None:
    sim = simulator("stage_1", Pose2D(1.86, 0.0), drive=drive)
    sim.step({})
    assert sim.touching()
    sim.place(Pose2D(0.0, 0.0))
    sim.step({})
    assert not sim.touching()


def test_both_drives_agree_where_nothing_slips(simulator: Callable[..., Simulator]) -> None:
    ends = []
    for params in ({"drive": "wheels"}, {"drive": "kinematic", "physics_rate": 60}):
        sim = simulator("empty", **params)
        for _ in range(5 * sim.params.physics_rate):
            sim.command(Twist2D(0.15, 0.4))
            sim.step({})
        ends.append(sim.world_from_base())
    assert math.hypot(ends[0].x - ends[1].x, ends[0].y - ends[1].y) < 0.01
    assert abs(ends[0].yaw - ends[1].yaw) < math.radians(1.0)
