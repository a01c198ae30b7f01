"""What a grade says besides its checks."""

from dataclasses import replace

import pytest
from grading_records import PLAN, RIGHT, changed

from robocop_grading.grader import grade
from robocop_grading.record import Line, Record
from robocop_grading.runner import Recorded, Runner
from robocop_grading.submission import Script, Submission


@pytest.mark.parametrize(
    "all_plots, bags", [(False, ["server-left.bag"]), (True, ["server-far.bag", "server-left.bag"])]
)
def test_bags_are_kept_of_scenarios_in_which_a_check_failed_unless_all_are_asked_for_and_none_of_an_earlier_grading(
    all_plots, bags, tmp_path, monkeypatch
):
    fast = changed(commands=tuple(replace(it, v=1.0) for it in RIGHT.commands))

    def run(_runner, _submission, _script, out):
        out.mkdir(parents=True)
        for name in ("left", "far"):
            (out / f"server-{name}.bag").touch()
        return Recorded({"left": fast, "far": replace(RIGHT, name="far")})

    monkeypatch.setattr(Runner, "run", run)
    monkeypatch.setattr("robocop_grading.report.write.write", lambda *_: None)  # its plots take seconds
    submission = Submission("anna", {}, [Script("server", tmp_path / "solution.py")])
    (tmp_path / "report").mkdir()
    (tmp_path / "report" / "server-right.bag").touch()
    grade(Runner(PLAN, tmp_path), submission, tmp_path / "report", all_plots=all_plots)
    assert sorted(path.name for path in (tmp_path / "report").glob("*.bag")) == bags


@pytest.mark.parametrize(
    "module, words",
    [
        (
            "scipy",
            "Python's module scipy is not installed here; if the lab has it, name its package in the plan, under "
            "packages",
        ),
        ("mine", "mine.py lies beside solution.py, but only solution.py was given: grade the folder"),
        ("folder", "folder lies beside solution.py, but only solution.py was given: grade the folder"),
    ],
)
def test_module_that_is_not_installed_or_was_left_behind_is_named(module, words, tmp_path, monkeypatch):
    lines = ["Traceback (most recent call last):", f"ModuleNotFoundError: No module named '{module}'"]
    record = Record("start", "server", up=False, lines=tuple(Line(0.0, line) for line in lines))
    monkeypatch.setattr(Runner, "run", lambda *_: Recorded({"start": record}))
    submission = Submission("anna", {}, [Script("server", tmp_path / "solution.py")], beside=["mine.py", "folder"])
    (problem,) = grade(Runner(PLAN, tmp_path), submission, tmp_path / "report").problems
    assert problem == f"server: {words}"
