"""A class in a few figures, and how long its grading takes still."""

import pytest

from robocop_grading.classroom.summary import Summary, pace


def test_figures_are_those_of_the_hand_ins_that_were_judged():
    assert Summary((3.0, 1.5, 2.0, 1.0), 4, 3.0).lines() == [
        "4 judged, 4 not gradable",
        "mean 1.88, median 1.75 of 3 points",
        "  0 to < 1    0",
        "  1 to < 2    2 " + "#" * 40,
        "  2 to < 3    1 " + "#" * 20,
        "         3    1 " + "#" * 20,
    ]
    assert Summary((), 4, 8.0).lines() == ["0 judged, 4 not gradable"]


@pytest.mark.parametrize("available", [0.0, 0.5, 1.0, 2.0, 7.5, 8.0, 10.0, 95.0, 1000.0])
def test_histogram_has_a_few_bars_and_everybody_in_one_of_them(available):
    points = [available * number / 200.0 for number in range(201)]
    histogram = Summary(points, 0, available).histogram
    assert sum(count for _, count in histogram) == 201
    assert len(histogram) <= 11 and histogram[-1][0] == f"{available:g}"
    assert histogram[-1][1] == (201 if available == 0.0 else 1), "full marks have a bar of their own"


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
