"""Which robots there are, and where each one starts."""

import math

import numpy as np
import pytest
from support import analytic_distances, model_named, world_named

from aro_robocop_goto_as.errors import ParameterError
from aro_robocop_goto_as.geometry import Pose2D
from aro_robocop_goto_as.params import SimParams
from aro_robocop_goto_as.robot import RobotModel
from aro_robocop_goto_as.spawns import free_places, parse_spawn, robots_from


def test_without_further_word_there_is_one_robot_without_a_name(burger: RobotModel) -> None:
    (robot,) = robots_from(SimParams(), world_named("stage_4"), lambda _: burger)
    assert (robot.name, robot.spawn) == ("", Pose2D(-0.7, 0.0, 0.0))


@pytest.mark.parametrize("world, count", [("stage_4", 10), ("world", 10), ("maze_1", 6), ("empty", 50)])
def test_a_number_of_robots_gets_free_places_within_the_same_room(burger: RobotModel, world: str, count: int) -> None:
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


def test_places_are_the_same_every_time() -> None:
    world = world_named("stage_4")
    assert free_places(world, world.spawn, 8) == free_places(world, world.spawn, 8)


def test_more_robots_than_there_is_room_for_are_refused(burger: RobotModel) -> None:
    with pytest.raises(ParameterError, match="world 'stage_1' has room for [0-9]+ around its spawn, 500 were asked"):
        robots_from(SimParams(robots="500"), world_named("stage_1"), lambda _: burger)


def test_a_list_names_and_places_each_robot(burger: RobotModel) -> None:
    robots = robots_from(SimParams(robots="red 0 0; blue 1 -1 3.14"), world_named("empty"), lambda _: burger)
    assert [(robot.name, robot.spawn) for robot in robots] == [("red", Pose2D()), ("blue", Pose2D(1.0, -1.0, 3.14))]


def test_a_list_may_name_a_model_for_a_robot() -> None:
    p = SimParams(robots="red 0 0; blue:waffle 1 -1", model="turtlebot2")
    robots = robots_from(p, world_named("empty"), model_named)
    assert [robot.model.name for robot in robots] == ["turtlebot2", "turtlebot3_waffle"]


@pytest.mark.parametrize("text, expected", [
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
])
def test_a_list_that_makes_no_sense_is_refused_by_name(burger: RobotModel, text: str, expected: str) -> None:
    with pytest.raises(ParameterError) as refusal:
        robots_from(SimParams(robots=text), world_named("empty"), lambda _: burger)
    assert expected in str(refusal.value)


def test_a_spawn_is_two_or_three_numbers() -> None:
    assert parse_spawn(" ", Pose2D(1, 2, 3)) == Pose2D(1, 2, 3)
    assert parse_spawn("1 -2", Pose2D()) == Pose2D(1.0, -2.0, 0.0)
    assert parse_spawn("1, 2, 0.5", Pose2D()) == Pose2D(1.0, 2.0, 0.5)
    for bad in ("1", "a b", "1 2 3 4", "nan 0", "-1e300 0", "0 0 inf"):
        with pytest.raises(ParameterError, match="spawn: expected 'x y' or 'x y yaw'"):
            parse_spawn(bad, Pose2D())
