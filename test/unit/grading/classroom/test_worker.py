"""Whatever a hand-in makes of the grader, it affects its own row only."""

import json

import pytest
from grading_records import PLAN

from robocop_grading.classroom import worker
from robocop_grading.classroom.results import Results


@pytest.mark.parametrize(
    "error", [RecursionError("too deep"), TypeError("a date"), MemoryError(), OSError(7, "too long")]
)
def test_whatever_a_hand_in_makes_of_the_grader_is_its_own_row(error, folder, monkeypatch):
    def fails(*_):
        raise error

    monkeypatch.setattr(worker, "open_sandbox", lambda *_: None)
    monkeypatch.setattr(worker, "prepare", fails)
    monkeypatch.setenv("ROBOCOP_STATE", "/nowhere")
    monkeypatch.setenv("ROBOCOP_SHARE", "/nowhere")
    worker.work(folder / "anna", PLAN, Results(folder / "out", PLAN), False)
    report = json.loads((folder / "out" / "anna" / "report.json").read_text())
    assert report["checks"] == [] and type(error).__name__ in report["problems"][0]
    assert type(error).__name__ in (folder / "out" / "anna" / "traceback.txt").read_text()
