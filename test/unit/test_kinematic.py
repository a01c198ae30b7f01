"""The kinematic engine: exact where the robot is free, and never through an obstacle."""

import math
from typing import Callable

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from support import world_named

from aro_robocop_goto_as.geometry import Pose2D, Pose3D, Twist2D
from aro_robocop_goto_as.physics.kinematic import KinematicEngine
from aro_robocop_goto_as.robot.base_controller import wheel_speeds
from aro_robocop_goto_as.robot.model import RobotModel
from aro_robocop_goto_as.simulation.simulator import Simulator
from aro_robocop_goto_as.world.model import Box, Cylinder, Obstacle, World
from aro_robocop_goto_as.world.scripted_motion import Motion

RADIUS = 0.105
WALL = World("wall", (Obstacle("wall", Pose3D((2.0, 0.0, 0.25)), Box((0.02, 4.0, 0.5))),), Pose2D(), (), "")
POST = World("post", (Obstacle("post", Pose3D((1.0, 0.0, 0.25)), Cylinder(0.1, 0.5)),), Pose2D(), (), "")


def _kinematics(model: RobotModel, world: World, *spawns: Pose2D, rate: int = 30) -> KinematicEngine:
    engine = KinematicEngine(world, rate, RADIUS)
    for spawn in spawns:
        engine.add_robot(model, spawn)
    return engine


def _drive(engine: KinematicEngine, *velocities: "tuple[float, float]") -> None:
    for robot, (v, w) in enumerate(velocities):
        engine.set_wheel_speeds(robot, wheel_speeds(Twist2D(v, w), 0.033, 0.16))


@given(st.floats(-0.3, 0.3), st.floats(-3.0, 3.0), st.integers(1, 100))
def test_robot_without_obstacles_follows_the_exact_arc(burger: RobotModel, v: float, w: float, steps: int) -> None:
    engine = _kinematics(burger, world_named("empty"), Pose2D())
    _drive(engine, (v, w))
    for _ in range(steps):
        engine.step()
    t = steps / 30.0
    chord = v * t * np.sinc(w * t / (2.0 * math.pi))
    x, y = chord * math.cos(w * t / 2.0), chord * math.sin(w * t / 2.0)
    assert (engine.state(0).world_from_footprint.x, engine.state(0).world_from_footprint.y) == pytest.approx(
        (x, y), abs=1e-9
    )


@pytest.mark.parametrize("v", [0.1, 1.0, 30.0, 1e4])
@pytest.mark.parametrize("rate", [30, 100])
def test_robot_stops_in_contact_with_a_wall_at_any_speed(burger: RobotModel, v: float, rate: int) -> None:
    engine = _kinematics(burger, WALL, Pose2D(), rate=rate)
    _drive(engine, (v, 0.0))
    for _ in range(int(2.5 / v * rate) + 2):
        engine.step()
    assert engine.state(0).world_from_footprint.x == pytest.approx(2.0 - 0.01 - RADIUS, abs=1e-4)
    assert engine.touching(0) and engine.state(0).twist.v == pytest.approx(0.0, abs=1e-3)


def test_robot_that_a_moving_obstacle_pushes_stops_at_another_robot(burger: RobotModel) -> None:
    along_x = Motion(Pose2D(-0.3, 0.0), waypoints=((10.0, 1.0, 0.0),))
    block = Obstacle("block", Pose3D((-0.3, 0.0, 0.25)), Cylinder(0.1, 0.5), along_x)
    engine = _kinematics(burger, World("push", (block,), Pose2D(), (), ""), Pose2D(), Pose2D(0.3, 0.0))
    for step in range(1, 100):
        engine.step()
        engine.move_obstacles(step / 30.0)
    x = [engine.state(robot).world_from_footprint.x for robot in (0, 1)]
    assert x == pytest.approx([0.3 - 2.0 * RADIUS, 0.3], abs=1e-5)
    assert engine.touching(0)


def test_robot_at_a_wall_can_turn_and_back_out(burger: RobotModel) -> None:
    engine = _kinematics(burger, WALL, Pose2D(1.5, 0.0))
    _drive(engine, (1.0, 0.0))
    for _ in range(60):
        engine.step()
    _drive(engine, (0.0, 1.0))
    for _ in range(30):
        engine.step()
    assert engine.state(0).world_from_footprint.yaw == pytest.approx(1.0)
    _drive(engine, (-1.0, 0.0))
    for _ in range(30):
        engine.step()
    assert engine.state(0).world_from_footprint.x == pytest.approx(2.0 - 0.01 - RADIUS - math.cos(1.0), abs=1e-3)


@given(st.floats(-math.pi, math.pi), st.floats(0.01, 300.0), st.floats(-5.0, 5.0))
def test_robot_never_penetrates_an_obstacle(burger: RobotModel, yaw: float, v: float, w: float) -> None:
    world = world_named("stage_2")
    engine = _kinematics(burger, world, Pose2D(0.0, 0.0, yaw))
    _drive(engine, (v, w))
    for _ in range(40):
        engine.step()
        x, y = engine.state(0).world_from_footprint.x, engine.state(0).world_from_footprint.y
        assert max(abs(x), abs(y)) < 1.85 - RADIUS + 1e-9
        for cx in (-0.6, 0.6):
            for cy in (-0.6, 0.6):
                assert math.hypot(x - cx, y - cy) > 0.15 + RADIUS - 1e-9


@given(st.lists(st.tuples(st.floats(-0.5, 0.5), st.floats(-3, 3)), min_size=4, max_size=4))
def test_colliding_robots_never_overlap(burger: RobotModel, velocities: "list[tuple[float, float]]") -> None:
    spawns = [Pose2D(0.0, 0.0, 0.0), Pose2D(0.4, 0.0, math.pi), Pose2D(0.0, 0.4, -1.5), Pose2D(0.4, 0.4, -2.3)]
    engine = _kinematics(burger, POST, *spawns)
    _drive(engine, *velocities)
    for _ in range(60):
        engine.step()
        poses = [engine.state(robot).world_from_footprint for robot in range(4)]
        places = np.array([(pose.x, pose.y) for pose in poses])
        apart = np.hypot(*(places[:, None] - places[None]).transpose(2, 0, 1)) + np.eye(4)
        assert apart.min() > 2.0 * RADIUS - 1e-9


def test_odometry_continues_while_the_wheels_slip_at_a_wall(simulator: Callable[..., Simulator]) -> None:
    sim = simulator("stage_1", Pose2D(1.6, 0.0), drive="kinematic", physics_rate=60)
    for _ in range(120):
        sim.command(Twist2D(0.22, 0.0))
        seen = sim.step({"odom": [0]})
    assert seen is not None and seen.odometry is not None
    assert sim.touching()
    assert seen.odometry[0].odom_from_footprint.x > sim.world_from_footprint().x - 1.6 + 0.1


@pytest.mark.parametrize("drive", ["kinematic", "wheels"])
def test_robot_placed_in_a_wall_touches_it_at_once(simulator: Callable[..., Simulator], drive: str) -> None:
    sim = simulator("stage_1", Pose2D(1.86, 0.0), drive=drive)
    sim.step({})
    assert sim.touching()
    sim.place(Pose2D(0.0, 0.0))
    sim.step({})
    assert not sim.touching()


def test_robot_blocked_by_a_wall_can_be_reset_in_a_world_without_round_obstacles(burger: RobotModel) -> None:
    engine = _kinematics(burger, WALL, Pose2D(1.85, 0.0))
    _drive(engine, (1.0, 0.0))
    for _ in range(10):
        engine.step()
    engine.reset([Pose2D(1.0, 0.0)])
    assert engine.state(0).world_from_footprint == Pose2D(1.0, 0.0)
    assert not engine.touching(0)


def test_both_engines_agree_without_slip(simulator: Callable[..., Simulator]) -> None:
    ends = []
    for params in ({"drive": "wheels"}, {"drive": "kinematic", "physics_rate": 60}):
        sim = simulator("empty", **params)
        for _ in range(5 * sim.config.rates.physics):
            sim.command(Twist2D(0.15, 0.4))
            sim.step({})
        ends.append(sim.world_from_footprint())
    assert math.hypot(ends[0].x - ends[1].x, ends[0].y - ends[1].y) < 0.01
    assert abs(ends[0].yaw - ends[1].yaw) < math.radians(1.0)
