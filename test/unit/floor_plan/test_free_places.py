"""Robots start where there is room for them: in worlds without a spawn, in maps, and several in one world."""

import math
from dataclasses import replace

import numpy as np
import pytest
from map_files import room, write_map
from support import analytic_distances, model_named, world_named

from aro_robocop_goto_as.errors import ParameterError
from aro_robocop_goto_as.floor_plan.free_places import free_place, occupant
from aro_robocop_goto_as.geometry import Pose2D, Pose3D
from aro_robocop_goto_as.shapes import Box, Cylinder
from aro_robocop_goto_as.simulation.factory import robots_from
from aro_robocop_goto_as.simulation.params import SimParams
from aro_robocop_goto_as.world.load import load_world
from aro_robocop_goto_as.world.model import Obstacle, World


@pytest.mark.parametrize("world, count", [("stage_4", 10), ("world", 10), ("maze_1", 6), ("empty", 50)])
def test_several_robots_get_free_places_within_the_same_room(burger, world, count):
    description = world_named(world)
    robots = robots_from(SimParams.of(robots=str(count)).robots, description, lambda _: burger)
    assert [robot.name for robot in robots] == [f"robot_{i}" for i in range(1, count + 1)]
    around = np.linspace(0.0, 2.0 * math.pi, 60)
    for i, robot in enumerate(robots):
        ring = analytic_distances(description, robot.spawn.x, robot.spawn.y, around, 100.0)
        assert ring.min() > 0.29
        assert np.isfinite(ring).all() or world == "empty"
        for other in robots[:i]:
            assert math.hypot(robot.spawn.x - other.spawn.x, robot.spawn.y - other.spawn.y) > 0.49


PILLARS = tuple(
    Obstacle(f"pillar_{x}_{y}/link/c", Pose3D((1.1 * x, 1.1 * y, 0.25)), Cylinder(0.15, 0.5))
    for x in (-1, 0, 1)
    for y in (-1, 0, 1)
)
NO_SPAWN = World("pillars", PILLARS, Pose2D(), (), "", has_spawn=False)


@pytest.mark.parametrize("model", ["burger", "waffle"])
def test_in_a_world_without_a_spawn_the_robot_starts_where_there_is_room(model):
    (robot,) = robots_from(SimParams.of(model=model).robots, NO_SPAWN, model_named)
    gaps = [math.dist((robot.spawn.x, robot.spawn.y), o.pose.position[:2]) - 0.15 for o in PILLARS]
    assert min(gaps) >= 0.3 and math.hypot(robot.spawn.x, robot.spawn.y) < 0.6


def test_what_is_in_the_way_is_named(tmp_path, burger):
    assert occupant(NO_SPAWN, Pose2D(), burger) == "occupied by 'pillar_0_0/link/c'"
    corner = load_world(write_map(tmp_path, room(), origin="[1, -0.7, 0]"))
    assert occupant(corner, Pose2D(), burger) == "unknown in the map"


def test_a_spawn_that_is_given_or_that_has_room_is_kept(burger):
    assert robots_from(SimParams.of(spawn="0 0.1").robots, NO_SPAWN, lambda _: burger)[0].spawn == Pose2D(0.0, 0.1)
    assert robots_from(SimParams().robots, replace(NO_SPAWN, has_spawn=True), lambda _: burger)[0].spawn == Pose2D()
    beside = replace(NO_SPAWN, obstacles=(replace(PILLARS[4], pose=Pose3D((0.3, 0.0, 0.25))),))
    assert robots_from(SimParams().robots, beside, lambda _: burger)[0].spawn == Pose2D()  # 0.045 m to spare


def test_where_there_is_less_room_the_robot_starts_where_its_footprint_fits(burger):
    blocks = tuple(
        Obstacle(f"b/{i}/c", Pose3D((x, 0.0, 0.25)), Box((90.0, 90.0, 0.5))) for i, x in enumerate((-44.8, 45.6))
    )
    place = free_place(World("alley", blocks, Pose2D(), (), ""), Pose2D(), burger)
    assert 0.2 + 0.125 <= place.x <= 0.6 - 0.125  # the alley is 0.4 m wide


def test_more_robots_than_there_is_room_for_are_refused(burger):
    with pytest.raises(
        ParameterError, match="world 'stage_1' has room for [0-9]+ around its spawn, 500 were requested"
    ):
        robots_from(SimParams.of(robots="500").robots, world_named("stage_1"), lambda _: burger)


def _start_in_map(model="burger", **params):
    """Where the robots of these parameters start in the map of a YAML file."""
    p = SimParams.of(model=model, **params).robots
    return lambda path: [robot.spawn for robot in robots_from(p, load_world(path), model_named)]


def test_in_a_map_the_robot_starts_at_zero_or_at_the_nearest_free_place(tmp_path):
    start = _start_in_map()
    assert start(write_map(tmp_path, room(), origin="[-1, -0.7, 0]")) == [Pose2D()]
    (moved,) = start(write_map(tmp_path, room(), origin="[1, -0.7, 0]"))
    assert (moved.x, moved.y) == (pytest.approx(1.375), pytest.approx(0.0, abs=0.03))
    (far,) = start(write_map(tmp_path, room(), origin="[500, -300, 1]"))
    assert math.hypot(far.x - 500.0, far.y + 300.0) < 2.5 and far.yaw == 0.0
    (narrow,) = start(write_map(tmp_path, room(9, 9)))
    assert 0.17 < narrow.x < 0.28 and 0.17 < narrow.y < 0.28


def test_in_a_map_the_robot_starts_in_a_known_cell_with_room_for_its_model(tmp_path):
    pixels = np.zeros((80, 80))
    pixels[36:44] = 254  # a corridor 0.4 m wide along x, which leads out of the map
    pixels[20:60, 60:78] = 254  # and a room at its end, from x 1 to x 1.9
    path = write_map(tmp_path, pixels, origin="[-2, -2, 0]")
    assert _start_in_map()(path)[0].x < 2.0
    (wide,) = _start_in_map("waffle")(path)
    assert 1.22 <= wide.x <= 1.68 and abs(wide.y) <= 0.78


@pytest.mark.parametrize("value", [0, 205])
def test_a_map_without_room_for_a_robot_is_refused(tmp_path, value):
    with pytest.raises(ParameterError, match="world 'm' has no room for a robot within 30 m of x 0 y 0"):
        _start_in_map()(write_map(tmp_path, np.full((9, 9), value)))
