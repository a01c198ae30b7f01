"""What the page says of the server."""

import time
from unittest.mock import MagicMock

import pytest
from aro_robocop_goto_as.msg import SimStatus

from aro_robocop_goto_as.ros import graph
from aro_robocop_goto_as.ros.web.frames import Frames
from aro_robocop_goto_as.ros.web.part import Context
from aro_robocop_goto_as.ros.web.status import StatusPart
from aro_robocop_goto_as.web.state import PageState, SharedState


def made(state):
    return StatusPart(Context(MagicMock(), MagicMock(), SharedState(state), MagicMock(), Frames(), "map"))


def test_a_page_that_no_simulator_has_reported_to_says_whether_one_runs(monkeypatch):
    monkeypatch.setattr(graph, "no_simulator", lambda: "no simulator is running")
    status = made(PageState())
    status._alert = MagicMock()  # not the same as the other elements
    status.ask_master(PageState())
    status.show(PageState())
    assert "no simulator is running" in status._alert.content
    status._on_sim(0.0, SimStatus())
    status.ask_master(PageState())
    assert status._no_simulator == ""


@pytest.mark.parametrize(
    "slipped, words",
    [([], ""), ([""], "The wheels slipped at an obstacle"), (["red"], "The wheels of red slipped at an")],
)
def test_wheels_that_have_slipped_are_told_with_the_remedy(slipped, words):
    status = made(PageState())
    status._alert = MagicMock()
    status._on_sim(time.monotonic(), SimStatus(slipped=slipped))
    status.show(PageState())
    assert words in status._alert.content and ("Reset puts" in status._alert.content) == bool(slipped)


@pytest.mark.parametrize(
    "bridge, shown",
    [
        ("", "answers, no report from the bridge"),
        ("robocop_goto_as is ready, no goal yet", "ready"),
        ("goal x 0.30 y 0.00 in map is ACTIVE: driving, 0.10 m to go", "ready"),  # the bridge's next report follows
        (
            "waiting for robocop_goto_as; goal x 0.30 y 0.00 in map waits for it; advice",
            "waiting for robocop_goto_as; goal x 0.30 y 0.00 in map waits for it; advice",
        ),
        ("goal refused: no transform from map to odom", "goal refused: no transform from map to odom"),
    ],
)
def test_a_server_that_executes_no_goal_is_ready_unless_the_bridge_reports_something_else(bridge, shown):
    state = PageState(answering=True, executing=False)
    status = made(state)
    status._on_bridge(0.0, MagicMock(data=bridge))
    assert status._rows(state) == [("server", shown)]


def test_a_bridge_that_has_ended_no_longer_says_that_a_goal_waits():
    state = PageState(answering=True)
    status = made(state)
    status.subscribe_to_robot(MagicMock(), "")
    status._on_bridge(
        0.0, MagicMock(data="waiting for robocop_goto_as; goal x 0.30 y 0.00 in map waits for it; advice")
    )
    assert "goal x 0.30 y 0.00 in map waits" in str(status._rows(state))
    status._reports.impl = None  # nobody publishes it
    status.show(state)
    assert "waits" not in str(status._rows(state))
