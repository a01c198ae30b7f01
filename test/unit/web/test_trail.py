"""The polyline that shows where a robot has been."""

from aro_robocop_goto_as.web import trail


def test_a_trail_has_a_point_for_each_distance_and_a_limited_length() -> None:
    points: trail.Trail = ()
    added = 0
    for step in range(20 * trail.LONGEST):
        longer = trail.extended(points, step / 64.0, 0.0)
        added += longer is not points
        points = longer
    assert added == 5 * trail.LONGEST and len(points) == trail.LONGEST
    assert {(after[0] - before[0], *after[1:]) for before, after in zip(points, points[1:])} == {
        (0.0625, 0.0, trail.HEIGHT)
    }


def test_a_trail_begins_anew_where_the_robot_was_placed() -> None:
    points = trail.extended(trail.extended((), 0.0, 0.0), 0.1, 0.0)
    assert len(points) == 2
    assert trail.extended(points, 5.0, 5.0) == ((5.0, 5.0, trail.HEIGHT),)
