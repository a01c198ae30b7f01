"""The polyline that shows where a robot has been."""

import math

import pytest

from aro_robocop_goto_as.ros import trail


def driven(*places):
    """The points of a trail through times [s] and positions [m]."""
    made = trail.Trail()
    for place in places:
        made.add(*place)
    return made.points


def test_a_trail_has_a_point_for_each_distance_and_a_limited_length():
    points = driven(*((step / 64.0, step / 64.0, 0.0) for step in range(8 * trail.MAX_POINTS)))
    assert len(points) == trail.MAX_POINTS and points[-1][0] >= 8 * trail.MAX_POINTS / 64.0 - 0.0625
    assert {(after[0] - before[0], *after[1:]) for before, after in zip(points, points[1:])} == {
        (0.0625, 0.0, trail.HEIGHT)
    }


def test_a_trail_starts_again_where_the_robot_was_placed():
    assert driven((0.0, 1.0, 0.0), (0.1, 1.1, 0.0), (0.2, 0.0, 0.0)) == ((0.0, 0.0, trail.HEIGHT),)


def test_a_trail_starts_again_when_time_was_set_back():
    assert driven((9.0, 1.0, 0.0), (9.1, 1.1, 0.0), (0.0, 1.1, 0.0)) == ((1.1, 0.0, trail.HEIGHT),)


@pytest.mark.parametrize("wrong", [math.nan, math.inf])
def test_a_position_that_is_no_number_is_left_out(wrong):
    assert driven((0.0, 0.0, 0.0), (0.1, wrong, 0.0), (0.2, 0.1, 0.0)) == driven((0.0, 0.0, 0.0), (0.2, 0.1, 0.0))
