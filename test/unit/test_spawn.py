"""Names, models and spawn poses of the robots."""

import math
from dataclasses import replace

import numpy as np
import pytest
from support import analytic_distances, model_named, world_named

from aro_robocop_goto_as.errors import ParameterError
from aro_robocop_goto_as.geometry import Pose2D, Pose3D
from aro_robocop_goto_as.params import SimParams
from aro_robocop_goto_as.raycast.free_places import free_place, free_places
from aro_robocop_goto_as.robot.model import RobotModel
from aro_robocop_goto_as.simulation.robots import robots_from
from aro_robocop_goto_as.world.model import Box, Cylinder, Obstacle, World
from aro_robocop_goto_as.world.spawn import parse_spawn


def test_default_is_one_robot_without_a_name(burger: RobotModel) -> None:
    (robot,) = robots_from(SimParams().spawn_params(), world_named("stage_4"), lambda _: burger)
    assert (robot.name, robot.spawn) == ("", Pose2D(-0.7, 0.0, 0.0))


@pytest.mark.parametrize("world, count", [("stage_4", 10), ("world", 10), ("maze_1", 6), ("empty", 50)])
def test_several_robots_get_free_places_within_the_same_room(burger: RobotModel, world: str, count: int) -> None:
    description = world_named(world)
    robots = robots_from(SimParams(robots=str(count)), description, lambda _: burger)
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


@pytest.mark.parametrize("model, least", [("burger", 0.3), ("waffle", 0.3)])
def test_in_a_world_without_a_spawn_the_robot_starts_where_there_is_room(model: str, least: float) -> None:
    (robot,) = robots_from(SimParams(model=model).spawn_params(), NO_SPAWN, model_named)
    gaps = [math.dist((robot.spawn.x, robot.spawn.y), o.pose.position[:2]) - 0.15 for o in PILLARS]
    assert min(gaps) >= least and math.hypot(robot.spawn.x, robot.spawn.y) < 0.6


def test_several_robots_start_where_there_is_room_too(burger: RobotModel) -> None:
    for robot in robots_from(SimParams(robots="6").spawn_params(), NO_SPAWN, lambda _: burger):
        gaps = [math.dist((robot.spawn.x, robot.spawn.y), o.pose.position[:2]) - 0.15 for o in PILLARS]
        assert min(gaps) >= 0.3 - 1e-9


def test_a_spawn_that_is_given_or_that_has_room_is_kept(burger: RobotModel) -> None:
    assert robots_from(SimParams(spawn="0 0.1").spawn_params(), NO_SPAWN, lambda _: burger)[0].spawn == Pose2D(0.0, 0.1)
    assert (
        robots_from(SimParams().spawn_params(), replace(NO_SPAWN, has_spawn=True), lambda _: burger)[0].spawn
        == Pose2D()
    )
    beside = replace(NO_SPAWN, obstacles=(replace(PILLARS[4], pose=Pose3D((0.3, 0.0, 0.25))),))
    assert robots_from(SimParams().spawn_params(), beside, lambda _: burger)[0].spawn == Pose2D()  # 0.045 m to spare


def test_where_there_is_less_room_the_robot_starts_where_its_footprint_fits(burger: RobotModel) -> None:
    blocks = tuple(
        Obstacle(f"b/{i}/c", Pose3D((x, 0.0, 0.25)), Box((90.0, 90.0, 0.5))) for i, x in enumerate((-44.8, 45.6))
    )
    place = free_place(World("alley", blocks, Pose2D(), (), ""), Pose2D(), burger)
    assert 0.2 + 0.125 <= place.x <= 0.6 - 0.125  # the alley is 0.4 m wide
    with pytest.raises(ParameterError, match="world 'full' has no room for a robot within 30 m of x 0 y 0"):
        free_place(
            World("full", (Obstacle("o/l/c", Pose3D(), Box((99.0, 99.0, 1.0))),), Pose2D(), (), ""), Pose2D(), burger
        )


def test_several_robots_start_in_a_corridor_that_is_just_wide_enough_for_them(burger: RobotModel) -> None:
    walls = tuple(Obstacle(f"w/{y}/c", Pose3D((0.0, y, 0.25)), Box((20.0, 0.1, 0.5))) for y in (-0.2, 0.2))
    corridor = World("corridor", walls, Pose2D(), (), "", has_spawn=False)
    robots = robots_from(SimParams(robots="5").spawn_params(), corridor, lambda _: burger)
    assert sorted((robot.spawn.x, robot.spawn.y) for robot in robots) == [(x / 2, 0.0) for x in range(-2, 3)]


def test_places_are_the_same_every_time() -> None:
    world, burger = world_named("stage_4"), model_named("burger")
    assert free_places(world, world.spawn, 8, burger) == free_places(world, world.spawn, 8, burger)


def test_more_robots_than_there_is_room_for_are_refused(burger: RobotModel) -> None:
    with pytest.raises(
        ParameterError, match="world 'stage_1' has room for [0-9]+ around its spawn, 500 were requested"
    ):
        robots_from(SimParams(robots="500").spawn_params(), world_named("stage_1"), lambda _: burger)


def test_a_list_names_and_places_each_robot(burger: RobotModel) -> None:
    robots = robots_from(
        SimParams(robots="red 0 0; blue 1 -1 3.14").spawn_params(), world_named("empty"), lambda _: burger
    )
    assert [(robot.name, robot.spawn) for robot in robots] == [("red", Pose2D()), ("blue", Pose2D(1.0, -1.0, 3.14))]


def test_a_list_may_name_a_model_for_a_robot() -> None:
    p = SimParams(robots="red 0 0; blue:waffle 1 -1", model="turtlebot2").spawn_params()
    robots = robots_from(p, world_named("empty"), model_named)
    assert [robot.model.name for robot in robots] == ["turtlebot2", "turtlebot3_waffle"]


@pytest.mark.parametrize(
    "text, expected",
    [
        ("0", "expected at least 1"),
        ("red", "expected 'NAME X Y"),
        ("red 1", "expected 'x y' or 'x y yaw'"),
        ("red: 0 0", "got 'red: 0 0'"),
        (":waffle 0 0", "or 'NAME:MODEL X Y [YAW]; ...'"),
        ("red 0 0; red 1 1", "'red' is given twice"),
        ("r/d 0 0", "got 'r/d 0 0'"),
        ("red 0 0;", "expected 'NAME X Y"),
        ("red nan 0", "robots: red: expected 'x y'"),
        ("red 1e7 0", "numbers within +-1e+06, got '1e7 0'"),
    ],
)
def test_malformed_list_is_refused_by_name(burger: RobotModel, text: str, expected: str) -> None:
    with pytest.raises(ParameterError) as refusal:
        robots_from(SimParams(robots=text).spawn_params(), world_named("empty"), lambda _: burger)
    assert expected in str(refusal.value)


def test_a_spawn_is_two_or_three_numbers() -> None:
    assert parse_spawn(" ", Pose2D(1, 2, 3)) == Pose2D(1, 2, 3)
    assert parse_spawn("1 -2", Pose2D()) == Pose2D(1.0, -2.0, 0.0)
    assert parse_spawn("1, 2, 0.5", Pose2D()) == Pose2D(1.0, 2.0, 0.5)
    for bad in ("1", "a b", "1 2 3 4", "nan 0", "-1e300 0", "0 0 inf"):
        with pytest.raises(ParameterError, match="spawn: expected 'x y' or 'x y yaw'"):
            parse_spawn(bad, Pose2D())
