"""What the grader makes of what the probe says, with a shell in the probe's place."""

import pytest

from aro_robocop_goto_as.errors import GradingError
from aro_robocop_goto_as.grading import runner

BUDGET = 1.0  # [s, wall]


def watched(script, folder):
    """What comes of a probe that is this script."""
    said = []
    command = ["bash", "-c", script]
    return runner._watch(command, {"PATH": "/usr/bin:/bin"}, folder, "server", said.append, BUDGET), said


def test_probe_that_takes_longer_than_its_budget_is_ended_with_the_scenario_it_was_at(tmp_path):
    recorded, said = watched("echo begin far; sleep 60", tmp_path)
    assert recorded.problem == "time-out: not all scenarios were done within 1 s of wall time, it was at far"
    assert said == ["far"]


def test_time_slept_for_those_who_watch_does_not_count_for_the_budget(tmp_path):
    recorded, _ = watched("for i in 1 2 3 4; do sleep 0.5; echo slept 0.5; done", tmp_path)
    assert recorded.problem == ""


def test_watching_that_is_impossible_is_an_error_and_no_fault_of_the_submission(tmp_path):
    with pytest.raises(GradingError, match="^RViz did not come up: no display$"):
        watched("echo error RViz did not come up: no display; sleep 60", tmp_path)
