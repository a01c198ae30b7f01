"""How the grader interprets a session's output, with a shell in place of the session."""

from pathlib import Path

import pytest
from support import ROOT

from aro_robocop_goto_as.errors import GradingError, NoTimeError
from robocop_grading.plan import load
from robocop_grading.runner import Runner

PLAN = load(Path(ROOT, "config", "grading.yaml"))
BUDGET = 1.0  # [s, wall]


def supervised(script, folder):
    """The outcome of a session that is this script, and the scenarios it announced."""
    announced = []
    command = ["bash", "-c", script]
    runner = Runner(PLAN, folder, on_progress=lambda _part, name: announced.append(name), budget=BUDGET)
    return runner.supervise(command, {"PATH": "/usr/bin:/bin"}, folder, "server"), announced


@pytest.mark.parametrize(
    "script, reason",
    [
        ("echo begin far; sleep 60", "^server: not done within 1 s, stopped at far$"),
        ("echo busy no ROS master within 600 s; sleep 60", "^server: no ROS master within 600 s$"),
    ],
)
def test_session_for_which_the_machine_has_no_time_gets_no_grade(script, reason, tmp_path):
    with pytest.raises(NoTimeError, match=reason):
        supervised(script, tmp_path)


def test_failure_to_show_the_run_is_an_error_and_not_blamed_on_the_submission(tmp_path):
    with pytest.raises(GradingError, match="^RViz did not come up: no display$"):
        supervised("echo error RViz did not come up: no display; sleep 60", tmp_path)
