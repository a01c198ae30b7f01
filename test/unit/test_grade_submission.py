"""A part that was killed from outside is run once more; a second time it is not graded."""

from pathlib import Path

import pytest
from support import ROOT

from aro_robocop_goto_as.errors import UngradableError
from aro_robocop_goto_as.grading import grade_submission as module
from aro_robocop_goto_as.grading.plan import load
from aro_robocop_goto_as.grading.record import Death, Record
from aro_robocop_goto_as.grading.runner import Recorded
from aro_robocop_goto_as.grading.submission import Script, Submission

PLAN = load(Path(ROOT, "config", "grading.yaml"))
KILLED = Recorded({}, killed="the server was killed in scenario far")
GRADED = Recorded({"start": Record("start", "server", servers=("/other",), types=("",), up=False)})


def graded(outcomes, folder, monkeypatch):
    """The grade of a server whose runs have these outcomes."""
    left = list(outcomes)
    monkeypatch.setattr(module.runner, "run", lambda *_, **__: left.pop(0))
    submission = Submission("anna", folder, (), {}, [Script("server", folder, "node")])
    return module.grade_submission(submission, PLAN, folder / "report", folder, None)


def test_killed_part_is_run_again_and_the_grade_says_so(tmp_path, monkeypatch):
    grade = graded([KILLED, GRADED], tmp_path, monkeypatch)
    assert len(grade.checks) > 0
    assert grade.problems == (
        "server: the server was killed in scenario far by a SIGKILL that did not come from the grader "
        "(is the machine short of memory?); this part was run again",
    )


def test_part_that_is_killed_twice_is_not_gradable(tmp_path, monkeypatch):
    with pytest.raises(UngradableError, match="not gradable: the server was killed in scenario far by a SIGKILL"):
        graded([KILLED, KILLED], tmp_path, monkeypatch)


@pytest.mark.parametrize(
    "death, outside",
    [
        (Death(1.0, 137), True),  # as bubblewrap reports it
        (Death(1.0, -9), True),
        (Death(1.0, -9, "its processes together took more than 2048 MB of memory"), False),
        (Death(1.0, 1), False),
        (Death(1.0, 152), False),  # SIGXCPU, from its own limit
    ],
)
def test_only_a_sigkill_that_the_grader_did_not_send_is_from_outside(death, outside):
    assert death.is_from_outside == outside
