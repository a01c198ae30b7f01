"""What a grade says besides its checks."""

import pytest
from grading_records import PLAN

from robocop_grading.grader import grade
from robocop_grading.record import Line, Record
from robocop_grading.runner import Recorded, Runner
from robocop_grading.submission import Script, Submission


@pytest.mark.parametrize(
    "module, words",
    [
        ("scipy", "; if the lab has it, name its package in the plan, under packages"),
        ("ropsy", "; did you mean rospy?"),
    ],
)
def test_module_that_is_not_installed_is_named_as_mistyped_or_as_one_that_the_lab_may_have(
    module, words, tmp_path, monkeypatch
):
    lines = ["Traceback (most recent call last):", f"ModuleNotFoundError: No module named '{module}'"]
    record = Record("start", "server", up=False, lines=tuple(Line(0.0, line) for line in lines))
    monkeypatch.setattr(Runner, "run", lambda *_: Recorded({"start": record}))
    submission = Submission("anna", (), {}, [Script("server", tmp_path, "node")])
    (problem,) = grade(Runner(PLAN, tmp_path), submission, tmp_path / "report").notes
    assert problem == f"server: Python's module {module} is not installed here{words}"
