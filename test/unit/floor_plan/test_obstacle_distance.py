"""The distance from a point to the nearest obstacle as high as a robot, and whether a robot has room at a pose."""

import math

import numpy as np
import pytest
from support import analytic_distances, model_named, world_named

from aro_robocop_goto_as.floor_plan.obstacle_distance import ObstacleDistance
from aro_robocop_goto_as.geometry import Pose2D, Pose3D
from aro_robocop_goto_as.robot.model import MAX_SPACING, MIN_HEIGHT
from aro_robocop_goto_as.shapes import Box, Cylinder, Mesh, Plane, Sphere, Walls
from aro_robocop_goto_as.world.model import Obstacle, World

HEIGHTS = (0.02, 0.1, 0.18)
SQUARE = np.array([[[-1, -1], [1, -1]], [[1, -1], [1, 1]], [[1, 1], [-1, 1]], [[-1, 1], [-1, -1]]], float)
SHEET = Mesh(np.array([[[-9, 0, -9], [9, 0, -9], [0, 0, 9]]], float), "")


def _nearest(geometry, pose, x, y):
    world = World("w", (Obstacle("m/l/c", pose, geometry),), Pose2D(), (), "")
    return tuple(ObstacleDistance(world, HEIGHTS).nearest(x, y))


def test_cross_sections_of_a_body_reach_from_its_bottom_to_its_scanner_without_a_gap():
    for model in map(model_named, ("burger", "turtlebot2")):
        heights = model.body_heights()
        assert (heights[0], heights[-1]) == pytest.approx((MIN_HEIGHT, model.height_of(model.base_from_scan)))
        assert max(np.diff(heights)) <= MAX_SPACING


@pytest.mark.parametrize("name", ["stage_4", "world", "maze_1"])
def test_the_distance_is_that_of_the_nearest_of_many_rays(name):
    world = world_named(name)
    distance = ObstacleDistance(world, HEIGHTS)
    around = np.linspace(0.0, 2.0 * math.pi, 3600)
    for x, y in np.random.default_rng(1).uniform(-1.5, 1.5, (40, 2)):
        nearest = distance.nearest(x, y)
        rays = analytic_distances(world, x, y, around, 100.0).min()
        if nearest.distance > 0.0:
            assert nearest.distance == pytest.approx(rays, abs=2e-3)
        assert nearest.name in {obstacle.name for obstacle in world.obstacles}


@pytest.mark.parametrize(
    "geometry, pose, point, distance",
    [
        (Box((2.0, 2.0, 0.1)), Pose3D(), (0.3, 0.0), 0.0),
        (Box((2.0, 2.0, 0.1)), Pose3D(), (1.25, 0.0), 0.25),
        (Box((2.0, 2.0, 0.1)), Pose3D.from_xyz_rpy((0.0, 0.0, 0.0), (0.0, 0.0, math.pi / 4)), (0.0, 1.5), 1.5 - 2**0.5),
        (Cylinder(0.5, 1.0), Pose3D(), (0.1, 0.1), 0.0),
        (Cylinder(0.5, 3.0), Pose3D.from_xyz_rpy((0.0, 0.0, 0.1), (math.pi / 2, 0.0, 0.0)), (0.0, 1.0), 0.0),
        (Cylinder(0.5, 3.0), Pose3D.from_xyz_rpy((0.0, 0.0, 0.1), (math.pi / 2, 0.0, 0.0)), (0.0, 2.0), 0.5),
        (Sphere(0.5), Pose3D((0.0, 0.0, 0.1)), (0.6, 0.8), 0.5),
        (Walls(SQUARE, 0.5), Pose3D(), (0.9, 0.0), 0.0),
        (Walls(SQUARE, 0.5), Pose3D(), (0.0, -3.0), 2.0),
        (SHEET, Pose3D(), (0.0, 0.5), 0.5),
        (Plane((1.0, 0.0, 0.0)), Pose3D((2.0, 0.0, 0.0)), (0.0, 7.0), 2.0),
    ],
)
def test_solid_shapes_are_at_no_distance_from_a_point_within_them(geometry, pose, point, distance):
    assert _nearest(geometry, pose, *point) == (pytest.approx(distance, abs=2e-3), "m/l/c")


@pytest.mark.parametrize("pose", [Pose3D((0.0, 0.0, 0.5)), Pose3D((0.0, 0.0, -0.5))])
def test_what_is_above_the_robot_or_below_the_floor_does_not_count(pose):
    assert _nearest(Box((1.0, 1.0, 0.2)), pose, 0.0, 0.0) == (math.inf, "")
    assert _nearest(Plane((0.0, 0.0, 1.0)), pose, 0.0, 0.0) == (math.inf, "")
