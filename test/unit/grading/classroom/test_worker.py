"""Whatever a hand-in makes of the grader, it affects its own row only."""

import json

import pytest
from class_records import PLAN

from robocop_grading.classroom import worker
from robocop_grading.classroom.hand_ins import pack


@pytest.mark.parametrize(
    "error", [RecursionError("too deep"), TypeError("a date"), MemoryError(), OSError(7, "too long")]
)
def test_whatever_a_hand_in_makes_of_the_grader_is_its_own_row(error, folder, monkeypatch):
    def fails(*_):
        raise error

    monkeypatch.setattr(worker, "open_sandbox", lambda *_: None)
    monkeypatch.setattr(worker, "prepare_submission", fails)
    monkeypatch.setattr(worker, "_scratch", lambda: None)
    monkeypatch.setenv("ROBOCOP_STATE", "/nowhere")
    monkeypatch.setenv("ROBOCOP_SHARE", "/nowhere")
    anna = pack(folder / "anna")
    done = worker.work(worker.Task(anna, PLAN))
    report = json.loads(done.files["report.json"])
    assert report["checks"] == [] and type(error).__name__ in report["problems"][0]
