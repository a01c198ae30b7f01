"""What plots show: the last seconds."""

from unittest.mock import MagicMock

import pytest
from geometry_msgs.msg import Twist

from aro_robocop_goto_as.ros.web import plots
from aro_robocop_goto_as.ros.web.plots import SPAN
from aro_robocop_goto_as.web.state import PageState


@pytest.fixture
def context():
    context = MagicMock()
    context.server.gui.add_uplot.side_effect = lambda *_, **__: MagicMock()
    return context


def test_a_plot_goes_on_to_now_when_nothing_more_is_received_and_forgets_what_is_older_than_it_shows(
    context, monkeypatch
):
    plot, now = plots.plots(context)[1], [100.0]
    monkeypatch.setattr(plots.time, "monotonic", lambda: now[0])
    plot._on_message(100.0, Twist())
    plot._on_message(110.0, Twist())
    for now[0], times in ((115.0, [-15.0, -5.0]), (100.0 + SPAN + 1.0, [9.0 - SPAN]), (111.0 + SPAN, [0.0])):
        plot.show(PageState())
        assert plot._handle.data[0].tolist() == times
