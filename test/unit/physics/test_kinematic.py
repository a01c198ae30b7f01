"""The kinematic engine: exact where a robot is free, never through an obstacle; and against its definition."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from support import ORIGIN, model_named, world_named

from aro_robocop_goto_as.geometry import Pose2D, Pose3D
from aro_robocop_goto_as.physics.kinematic import KinematicEngine
from aro_robocop_goto_as.robot.base_controller import BaseLimits
from aro_robocop_goto_as.robot.fleet import Fleet
from aro_robocop_goto_as.shapes import Box, Cylinder, Plane
from aro_robocop_goto_as.world.model import Obstacle, World
from aro_robocop_goto_as.world.scripted_motion import Motion

RADIUS = 0.105
AT_ONCE = BaseLimits(math.inf, math.inf, math.inf, math.inf, 0.0)


def _world(*obstacles):
    return World("w", obstacles, Pose2D(), (), "")


def _box(x, y, yaw, length, width):
    return Obstacle("box", Pose3D.from_xyz_rpy((x, y, 0.25), (0.0, 0.0, yaw)), Box((length, width, 0.5)))


def _post(x, y, radius, motion=None):
    return Obstacle("post", Pose3D((x, y, 0.25)), Cylinder(radius, 0.5), motion)


def _kinematics(world, *spawns, radii=None):
    n = len(spawns)
    engine = KinematicEngine(world, Fleet([model_named("burger")] * n, [AT_ONCE] * n, radii or [RADIUS] * n), 30)
    engine.reset(spawns)
    return engine


def _drive(engine, steps, *velocities):
    engine.fleet.commands[: len(velocities)] = velocities
    engine.advance(0, steps)


PLANE = Obstacle("plane", Pose3D((1.99, 0.0, 0.0)), Plane((-1.0, 0.0, 0.0)))  # too long for the tiles of an index


@pytest.mark.parametrize("wall", [_box(2.0, 0.0, 0.0, 0.02, 4.0), PLANE])
@pytest.mark.parametrize("v", [0.1, 1.0, 1e4])
def test_robot_stops_in_contact_with_a_wall_at_any_speed(wall, v):
    engine = _kinematics(_world(wall), ORIGIN)
    _drive(engine, int(2.5 / v * 30) + 2, (v, 0.0))
    assert engine.fleet.pose(0).x == pytest.approx(2.0 - 0.01 - RADIUS, abs=1e-4)
    assert engine.touching(0) and engine.fleet.twists[0, 0] == pytest.approx(0.0, abs=1e-3)


def test_robot_that_a_moving_obstacle_pushes_stops_at_another_robot():
    along_x = Motion(Pose2D(-0.3, 0.0), waypoints=((10.0, 1.0, 0.0),))
    engine = _kinematics(_world(_post(-0.3, 0.0, 0.1, along_x)), ORIGIN, Pose2D(0.3, 0.0))
    for step in range(1, 100):
        engine.advance(step, 1)
        engine.move_obstacles(step / 30.0)
    assert engine.fleet.poses[:, 0] == pytest.approx([0.3 - 2.0 * RADIUS, 0.3], abs=1e-5)
    assert engine.touching(0)
    engine.reset([ORIGIN, Pose2D(0.3, 0.0)])
    engine.advance(0, 1)
    assert not engine.touching(0), "the obstacle is back at its start"


@given(st.floats(-math.pi, math.pi), st.floats(0.01, 300.0), st.floats(-5.0, 5.0))
def test_robot_never_penetrates_an_obstacle(yaw, v, w):
    engine = _kinematics(world_named("stage_2"), Pose2D(0.0, 0.0, yaw))
    for _ in range(40):
        _drive(engine, 1, (v, w))
        x, y, _ = engine.fleet.pose(0)
        assert max(abs(x), abs(y)) < 1.85 - RADIUS + 1e-9
        for cx in (-0.6, 0.6):
            for cy in (-0.6, 0.6):
                assert math.hypot(x - cx, y - cy) > 0.15 + RADIUS - 1e-9


@given(st.lists(st.tuples(st.floats(-0.5, 0.5), st.floats(-3, 3)), min_size=4, max_size=4))
def test_colliding_robots_of_several_sizes_never_overlap(velocities):
    spawns = [Pose2D(0.0, 0.0, 0.0), Pose2D(0.4, 0.0, math.pi), Pose2D(0.0, 0.4, -1.5), Pose2D(0.4, 0.4, -2.3)]
    radii = np.array([0.08, 0.105, 0.12, 0.2])
    engine = _kinematics(_world(_post(1.0, 0.0, 0.1)), *spawns, radii=radii.tolist())
    for _ in range(60):
        _drive(engine, 1, *velocities)
        places = engine.fleet.poses[:, :2]
        apart = np.hypot(*(places[:, None] - places[None]).transpose(2, 0, 1))
        assert (apart > radii + radii[:, None] - 1e-9)[~np.eye(4, dtype=bool)].all()


def test_robots_of_different_heights_and_radii_are_blocked_by_what_is_at_their_height():
    bar = Obstacle("bar", Pose3D((1.0, 0.0, 0.25)), Box((0.1, 10.0, 0.2)))  # from 0.15 m up
    fleet = Fleet([model_named("burger"), model_named("waffle")], [AT_ONCE] * 2, [0.1, 0.2])
    engine = KinematicEngine(_world(bar, _post(1.5, 2.0, 0.1)), fleet, 30)
    engine.reset([ORIGIN, Pose2D(0.0, 2.0)])
    fleet.commands[1] = 1.0, 0.0
    _drive(engine, 60, (1.0, 0.0))
    assert fleet.poses[0, 0] == pytest.approx(0.95 - 0.1, abs=1e-4)
    assert fleet.poses[1, 0] == pytest.approx(1.4 - 0.2, abs=1e-4), "lower than the bar"
