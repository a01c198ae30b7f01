"""What plots show: the last seconds."""

import time
from unittest.mock import MagicMock

import pytest
from geometry_msgs.msg import Twist

from aro_robocop_goto_as.ros.web import plots
from aro_robocop_goto_as.ros.web.plots import MOST, PLOTTED, SPAN, Plot, columns
from aro_robocop_goto_as.web.state import PageState


@pytest.fixture
def context():
    context = MagicMock()
    context.server.gui.add_uplot.side_effect = lambda *_, **__: MagicMock()
    return context


def test_the_last_messages_are_plotted_until_another_robot_is_selected(context):
    plot, inbox = Plot(context, PLOTTED[1]), MagicMock()
    plot.subscribe_to_robot(inbox, "blue")
    (topic, _, handler, _) = inbox.subscribe.call_args[0]
    assert topic == "/blue/cmd_vel"
    for _ in range(2 * MOST):
        handler(time.monotonic(), Twist())
    plot.show(PageState())
    assert plot._handle.data[0].shape == (MOST,)
    plot._shown_at = 0.0
    plot.subscribe_to_robot(inbox, "red")
    plot.show(PageState())
    assert plot._handle.data[0].shape == (1,)


def test_a_plot_goes_on_to_now_when_nothing_more_is_received_and_forgets_what_is_older_than_it_shows(
    context, monkeypatch
):
    plot, now = Plot(context, PLOTTED[1]), [100.0]
    monkeypatch.setattr(plots.time, "monotonic", lambda: now[0])
    plot._on_message(100.0, Twist())
    plot._on_message(110.0, Twist())
    for now[0], times in ((115.0, [-15.0, -5.0]), (100.0 + SPAN + 1.0, [9.0 - SPAN]), (111.0 + SPAN, [0.0])):
        plot.show(PageState())
        assert plot._handle.data[0].tolist() == times


def test_a_plot_without_samples_is_not_empty():
    assert [column.shape for column in columns((), 5.0)] == [(1,)] * 3
