"""What plot show: the last seconds, or all of a recording, what of it has been played, and when checks failed."""

import time
from unittest.mock import MagicMock

import numpy as np
import pytest
from geometry_msgs.msg import Twist

from aro_robocop_goto_as.ros.web import plots
from aro_robocop_goto_as.ros.web.plots import MOST, PLOTTED, POINTS, SPAN, Plot, RecordedPlot, columns, held
from aro_robocop_goto_as.ros.web.replay import Failure
from aro_robocop_goto_as.web.state import PageState


@pytest.fixture
def player():
    player = MagicMock(duration=20.0, position=5.0)
    player.samples.side_effect = lambda topic, _: ((10.0, 1.0, -1.0),) if topic == "/blue/cmd_vel" else ()
    return player


@pytest.fixture
def context():
    context = MagicMock()
    context.server.gui.add_uplot.side_effect = lambda *_, **__: MagicMock()
    return context


def test_the_whole_recording_is_plotted_with_the_played_part_and_the_failures_marked(player, context):
    plot = RecordedPlot(context, PLOTTED[1], player, [Failure("stops", 15.0, "")])
    plot.subscribe_to_robot(MagicMock(), "blue")
    plot.show(PageState())
    times, speed, turn, played, failed = plot._handle.data
    assert (len(times), times[0], times[-1]) == (POINTS, 0.0, 20.0)
    assert not speed[times < 10.0].any() and (speed[times >= 10.0] == 1.0).all() and turn[-1] == -1.0
    assert played.tolist() == (times <= 5.0).tolist()
    assert times[failed > 0.0] == pytest.approx([15.0], abs=20.0 / POINTS)


def test_plot_are_sent_only_when_the_cursor_moves(player, context):
    plot = RecordedPlot(context, PLOTTED[1], player, [])
    plot.subscribe_to_robot(MagicMock(), "")
    plot.show(PageState())
    sent = plot._handle.data
    plot.show(PageState())
    assert plot._handle.data is sent
    player.position = 6.0
    plot.show(PageState())
    assert plot._handle.data is not sent and np.sum(plot._handle.data[3]) > np.sum(sent[3])


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


def test_a_figure_holds_its_newest_value_and_is_zero_before_the_first():
    times = np.array((0.0, 1.0, 1.5, 2.0, 9.0))
    first, second = held(((1.0, 5.0, -5.0), (2.0, 7.0, -7.0)), times)
    assert first.tolist() == [0.0, 5.0, 5.0, 7.0, 7.0] and second.tolist() == [0.0, -5.0, -5.0, -7.0, -7.0]
    assert [figure.tolist() for figure in held((), times)] == [[0.0] * 5] * 2
