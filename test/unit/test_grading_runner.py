"""How the grader interprets the probe's output, with a shell in place of the probe."""

import pytest

from aro_robocop_goto_as.errors import GradingError
from aro_robocop_goto_as.grading import runner

BUDGET = 1.0  # [s, wall]


def supervised(script, folder):
    """The outcome of a probe that is this script, and the scenarios it announced."""
    announced = []
    command = ["bash", "-c", script]
    return runner._supervise(command, {"PATH": "/usr/bin:/bin"}, folder, "server", announced.append, BUDGET), announced


def test_probe_that_exceeds_its_budget_is_killed_and_its_scenario_is_named(tmp_path):
    recorded, announced = supervised("echo begin far; sleep 60", tmp_path)
    assert recorded.problem == "time-out: the scenarios took longer than 1 s of wall time, stopped at far"
    assert announced == ["far"]


def test_display_time_does_not_count_towards_the_budget(tmp_path):
    recorded, _ = supervised("for i in 1 2 3 4; do sleep 0.5; echo slept 0.5; done", tmp_path)
    assert recorded.problem == ""


def test_failure_to_show_the_run_is_an_error_and_not_blamed_on_the_submission(tmp_path):
    with pytest.raises(GradingError, match="^RViz did not come up: no display$"):
        supervised("echo error RViz did not come up: no display; sleep 60", tmp_path)
