"""A class in a few figures, and how long its grading takes still."""

import pytest

from robocop_grading.classroom.summary import Summary, pace


def test_figures_are_those_of_the_hand_ins_that_were_judged():
    figures = Summary((3.0, 1.5, 2.0, 1.0), 4, 3.0)
    assert (figures.counts, figures.averages) == ("4 judged, 4 not gradable", "mean 1.88, median 1.75 of 3 points")
    assert (Summary((), 4, 8.0).counts, Summary((), 4, 8.0).averages) == ("0 judged, 4 not gradable", "")


@pytest.mark.parametrize(
    "done, remaining, seconds, words",
    [
        (5, 16, 150.0, "2.0 a minute, about 8 min left"),
        (1, 199, 60.0, "1.0 a minute, about 3 h 19 min left"),
        (10, 1, 60.0, "10.0 a minute, about 1 min left"),
        (0, 200, 5.0, ""),
        (200, 0, 600.0, ""),
    ],
)
def test_time_left_follows_from_the_rate_so_far(done, remaining, seconds, words):
    assert pace(done, remaining, seconds) == words
