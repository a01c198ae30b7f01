"""The texts of the parameters that say which robots there are and where they start."""

import pytest
from support import model_named, world_named

from aro_robocop_goto_as.errors import ParameterError
from aro_robocop_goto_as.geometry import Pose2D
from aro_robocop_goto_as.simulation.factory import robots_from
from aro_robocop_goto_as.simulation.params import SimParams
from aro_robocop_goto_as.world.spawn_texts import parse_spawn


def test_default_is_one_robot_without_a_name(burger):
    (robot,) = robots_from(SimParams().robots, world_named("stage_4"), lambda _: burger)
    assert (robot.name, robot.spawn) == ("", Pose2D(-0.7, 0.0, 0.0))


def test_a_list_may_name_a_model_for_a_robot():
    p = SimParams.of(robots="red 0 0; blue:waffle 1 -1;", model="turtlebot2").robots
    robots = robots_from(p, world_named("empty"), model_named)
    assert [robot.model.name for robot in robots] == ["turtlebot2", "turtlebot3_waffle"]


@pytest.mark.parametrize(
    "text, expected",
    [
        ("0", "expected a number from 1 to 1000, got 0"),
        ("red", "expected a number, such as 3, or 'NAME X Y"),
        ("red 1", "expected 'x y' or 'x y yaw'"),
        (":waffle 0 0", "or 'NAME:MODEL X Y [YAW]; ...'"),
        ("red 0 0; red 1 1", "'red' is given twice"),
        ("r/d 0 0", "got 'r/d 0 0'"),
        (";", "or 'NAME X Y"),
        ("red 1e7 0", "numbers within +-1e+06, got '1e7 0'"),
    ],
)
def test_malformed_list_is_refused_by_name(burger, text, expected):
    with pytest.raises(ParameterError) as refusal:
        robots_from(SimParams.of(robots=text).robots, world_named("empty"), lambda _: burger)
    assert expected in str(refusal.value)


def test_a_spawn_is_two_or_three_numbers():
    assert parse_spawn(" ", Pose2D(1, 2, 3)) == Pose2D(1, 2, 3)
    assert parse_spawn("1 -2", Pose2D()) == Pose2D(1.0, -2.0, 0.0)
    assert parse_spawn("1, 2, 0.5", Pose2D()) == Pose2D(1.0, 2.0, 0.5)
    for bad in ("1", "a b", "1 2 3 4", "nan 0", "-1e300 0", "0 0 inf"):
        with pytest.raises(ParameterError, match="spawn: expected 'x y' or 'x y yaw'"):
            parse_spawn(bad, Pose2D())
