"""What plot show: the last seconds, or all of a recording, what of it has been played, and when checks failed."""

import time
from unittest.mock import MagicMock

import pytest
from geometry_msgs.msg import Twist

from aro_robocop_goto_as.ros.web.plots import MOST, PLOTTED, POINTS, SPAN, Plot, RecordedPlot, columns
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


def test_a_plot_shows_the_last_seconds_relative_to_now():
    samples = [(float(second), float(second), -float(second)) for second in range(100)]
    times, first, second_figure = columns(samples, 99.0)
    assert times.tolist() == [float(t) for t in range(-int(SPAN), 1)]
    assert first[-1] == 99.0 and second_figure[-1] == -99.0
    assert columns(samples, 109.0)[0][0] == -SPAN
