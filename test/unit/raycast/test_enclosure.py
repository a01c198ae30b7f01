"""Which goals are outside of the walls that a robot is in."""

import numpy as np
import pytest

from aro_robocop_goto_as.geometry import Pose3D
from aro_robocop_goto_as.raycast.enclosure import is_outside
from aro_robocop_goto_as.shapes import Box, Cylinder, Mesh, Sphere
from aro_robocop_goto_as.world.model import Obstacle


def wall(x: float, y: float, length: float, width: float, z: float = 0.25) -> Obstacle:
    return Obstacle("", Pose3D((x, y, z)), Box((length, width, 0.5)))


SIDES = [wall(0.0, 2.5, 5.15, 0.15), wall(0.0, -2.5, 5.15, 0.15), wall(-2.5, 0.0, 0.15, 5.15)]
ROOM = [*SIDES, wall(2.5, 0.0, 0.15, 5.15)]
DOOR = [*SIDES, wall(2.5, 1.5, 0.15, 2.15), wall(2.5, -1.5, 0.15, 2.15), wall(2.5, 0.0, 0.15, 1.0, z=2.3)]
COLUMNS = [
    Obstacle("", Pose3D((1.0, 0.0, 0.25)), Cylinder(0.15, 0.5)),
    Obstacle("", Pose3D((-1.0, 0.0, 0.15)), Sphere(0.15)),
]
PILLAR, BALL = (1.0, 0.0), (-1.0, 0.0)  # [m]
CORNERS = [(-2.5, -2.5), (2.5, -2.5), (2.5, 2.5), (-2.5, 2.5), (-2.5, -2.5)]  # [m]
SHEETS = [
    (x, y, z)
    for (ax, ay), (bx, by) in zip(CORNERS, CORNERS[1:])
    for x, y, z in ((ax, ay, 0.0), (bx, by, 0.0), (ax, ay, 1.0), (bx, by, 1.0), (ax, ay, 1.0), (bx, by, 0.0))
]
MESH_ROOM = [Obstacle("", Pose3D(), Mesh(np.array(SHEETS).reshape(-1, 3, 3), ""))]


@pytest.mark.parametrize("walls", [ROOM, MESH_ROOM])
@pytest.mark.parametrize("goal", [(9.0, 9.0), (2.8, 0.0), (-900.0, 3.0), (1e6, 0.0)])
def test_a_goal_beyond_the_walls_is_outside(walls, goal) -> None:
    assert is_outside(goal, (-0.7, 0.0), walls + COLUMNS)


def test_a_robot_close_to_a_wall_in_the_open_is_not_enclosed_although_far_obstacles_make_cells_large() -> None:
    assert not is_outside((5.0, 5.0), (0.0, 0.13), [wall(0.0, 0.0, 2.0, 0.1), wall(300.0, 0.0, 1.0, 1.0)])


@pytest.mark.parametrize("goal", [(2.3, 2.3), (-0.7, 0.0), PILLAR, BALL])
def test_a_goal_in_the_room_even_in_an_obstacle_is_not_outside(goal) -> None:
    assert not is_outside(goal, (-0.7, 0.0), ROOM + COLUMNS)


@pytest.mark.parametrize("world", [[], COLUMNS, SIDES, DOOR])
def test_no_goal_is_outside_where_no_walls_enclose_the_robot(world) -> None:
    assert not is_outside((9.0, 9.0), (-0.7, 0.5), world)


def test_no_goal_is_outside_of_walls_that_the_robot_is_not_in_either() -> None:
    assert not is_outside((9.0, 9.0), (5.0, 5.0), ROOM)
