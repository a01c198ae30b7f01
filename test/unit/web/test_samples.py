"""The samples of a plot."""

import numpy as np

from aro_robocop_goto_as.web.samples import MOST, SPAN, Samples, columns, extended, held


def test_a_plot_shows_the_last_seconds_relative_to_now() -> None:
    samples: Samples = ()
    for second in range(100):
        samples = extended(samples, float(second), float(second), -float(second))
    times, first, second_figure = columns(samples, 2, 99.0)
    assert times.tolist() == [float(t) for t in range(-int(SPAN), 1)]
    assert first[-1] == 99.0 and second_figure[-1] == -99.0
    assert columns(samples, 2, 109.0)[0][0] == -SPAN


def test_samples_are_limited_in_number_and_begin_anew_when_time_was_set_back() -> None:
    samples: Samples = ()
    for number in range(2 * MOST):
        samples = extended(samples, number / 1000.0, 0.0)
    assert len(samples) == MOST
    assert extended(samples, 0.5, 1.0) == ((0.5, 1.0),)


def test_a_plot_without_samples_is_not_empty() -> None:
    assert [column.shape for column in columns((), 2, 5.0)] == [(1,)] * 3


def test_a_figure_holds_its_newest_value_and_is_zero_before_the_first() -> None:
    times = np.array((0.0, 1.0, 1.5, 2.0, 9.0))
    (figure,) = held(((1.0, 5.0), (2.0, 7.0)), times, 1)
    assert figure.tolist() == [0.0, 5.0, 5.0, 7.0, 7.0]
    assert [figure.tolist() for figure in held((), times, 2)] == [[0.0] * 5] * 2
