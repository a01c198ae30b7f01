"""What the plots of a recording show: all of it, what has been played, and when checks failed."""

from unittest.mock import MagicMock

import numpy as np
import pytest

from aro_robocop_goto_as.ros.web.plots import POINTS, RecordedPlots
from aro_robocop_goto_as.web.report import Failure
from aro_robocop_goto_as.web.state import PageState, ReplayState


@pytest.fixture
def player():
    player = MagicMock(duration=20.0, state=ReplayState(5.0, 20.0, True, 1.0))
    player.samples.side_effect = lambda topic, _: ((10.0, 1.0, -1.0),) if topic == "/blue/cmd_vel" else ()
    return player


@pytest.fixture
def context():
    context = MagicMock()
    context.server.gui.add_uplot.side_effect = lambda *_, **__: MagicMock()
    return context


def test_the_whole_recording_is_plotted_with_the_played_part_and_the_failures_marked(player, context):
    plots = RecordedPlots(context, player, [Failure("stops", 15.0, "")])
    plots.subscribe_to_robot(MagicMock(), "blue")
    plots.show(PageState())
    times, speed, turn, played, failed = plots._handles[1].data
    assert (len(times), times[0], times[-1]) == (POINTS, 0.0, 20.0)
    assert not speed[times < 10.0].any() and (speed[times >= 10.0] == 1.0).all() and turn[-1] == -1.0
    assert played.tolist() == (times <= 5.0).tolist()
    assert times[failed > 0.0] == pytest.approx([15.0], abs=20.0 / POINTS)


def test_plots_are_sent_only_when_the_cursor_moves(player, context):
    plots = RecordedPlots(context, player, [])
    plots.subscribe_to_robot(MagicMock(), "")
    plots.show(PageState())
    sent = plots._handles[0].data
    plots.show(PageState())
    assert plots._handles[0].data is sent
    player.state = ReplayState(6.0, 20.0, True, 1.0)
    plots.show(PageState())
    assert plots._handles[0].data is not sent and np.sum(plots._handles[0].data[3]) > np.sum(sent[3])
