"""Moving obstacles: their pose is a function of simulated time, and they push robots."""

import math

import numpy as np
import pytest
from rasters import clearance
from support import world_named

from aro_robocop_goto_as.geometry import Pose2D, Pose3D
from aro_robocop_goto_as.robot.model import RobotSpec
from aro_robocop_goto_as.shapes import Box, Cylinder
from aro_robocop_goto_as.simulation.factory import make_simulator
from aro_robocop_goto_as.simulation.params import SimParams
from aro_robocop_goto_as.world.model import Obstacle, World
from aro_robocop_goto_as.world.scripted_motion import Motion, moving

PATROL = Motion(Pose2D(1.0, 2.0, math.pi / 2), waypoints=((4.0, 2.0, 0.0), (6.0, 2.0, 1.0), (10.0, 0.0, 0.0)))


@pytest.mark.parametrize(
    ("time", "x", "y"),
    [(0, 1, 2), (2, 1, 3), (4, 1, 4), (5, 0.5, 4), (6, 0, 4), (8, 0.5, 3), (10, 1, 2), (12, 1, 3), (1005, 0.5, 4)],
)
def test_waypoints_are_passed_at_their_times_in_every_cycle(time, x, y):
    pose = PATROL.carry(Pose2D(1.0, 2.0), time)
    assert (pose.x, pose.y) == (pytest.approx(x), pytest.approx(y))


def test_a_model_turns_counter_clockwise_about_its_origin():
    quarter = Motion(Pose2D(1.0, 2.0, 0.5), turn=math.pi / 4).carry(Pose2D(3.0, 2.0, 1.0), 2.0)
    assert quarter == pytest.approx((1.0, 4.0, 1.0 + math.pi / 2))


@pytest.mark.parametrize("name", ["stage_3", "stage_4"])
def test_moving_pillars_keep_clear_of_walls_and_spawn(name):
    world = world_named(name)
    walls = World("walls", tuple(o for o in world.obstacles if isinstance(o.geometry, Box)), Pose2D(), (), "")
    for time in np.linspace(0.0, 40.0, 401):
        places = np.array([o.at(float(time)).position[:2] for o in world.moving()])
        assert clearance(walls, places).min() > 0.2
        assert np.hypot(*(places - [world.spawn.x, world.spawn.y]).T).min() > 0.5


@pytest.mark.parametrize("drive", ["wheels", "kinematic"])
def test_standing_robot_is_pushed_by_a_moving_obstacle(simulator, drive):
    sim = simulator("stage_4", Pose2D(0.4, 0.0), drive=drive, moving=True)
    touched = False
    for _ in range(240 * 5):
        sim.advance({})
        touched = touched or sim.touching()
    pose, pillar = sim.world_from_footprint(), sim.world.moving()[0].at(5.0).position
    assert touched
    assert math.hypot(pose.x - pillar[0], pose.y - pillar[1]) > 0.17
    assert math.hypot(pose.x - 0.4, pose.y) > 0.2


def test_robot_is_not_pushed_through_a_wall(burger):
    wall = Obstacle("wall", Pose3D((0.2, 0.0, 0.25)), Box((0.1, 4.0, 0.5)))
    motion = Motion(Pose2D(-1.0, 0.0), waypoints=((10.0, 2.0, 0.0), (20.0, 0.0, 0.0)))
    post = Obstacle("post", Pose3D((-1.0, 0.02, 0.25)), Cylinder(0.2, 0.5), motion)
    p = SimParams.of(drive="kinematic", moving=True, footprint_radius=0.105)
    sim = make_simulator(p, World("w", (wall, post), Pose2D(), (), ""), [RobotSpec("", burger, Pose2D())])
    for _ in range(2400):
        sim.advance({})
        assert sim.world_from_footprint().x <= 0.15 - 0.105


def test_circles_are_put_where_the_motions_of_their_models_carry_them():
    circles = np.array([(7.0, 8.0, 0.9), (1.0, 2.5, 0.1)])
    move = moving(circles, [None, PATROL])
    farthest = move(5.0)
    assert circles[0].tolist() == [7.0, 8.0, 0.9]
    assert tuple(circles[1, :2]) == PATROL.carry(Pose2D(1.0, 2.5), 5.0)[:2]
    assert farthest == math.hypot(circles[1, 0] - 1.0, circles[1, 1] - 2.5) > 0.0
