"""Whatever a hand-in makes of the grader, it affects its own row only."""

import json
import subprocess
import sys
from unittest.mock import MagicMock

import pytest
from class_records import PLAN
from waiting import DEADLINE

from robocop_grading.classroom import worker
from robocop_grading.classroom.hand_ins import pack

# Nothing else can run in a process while poll() does: PyDLL keeps the interpreter.
HANGS = """
import ctypes
from robocop_grading.classroom.worker import ended_if_it_hangs
poll = ctypes.PyDLL(None).poll
with ended_if_it_hangs(0.1):
    pass
poll(None, 0, 1000)
print("alive", flush=True)
with ended_if_it_hangs(0.1):
    poll(None, 0, -1)
"""


def test_only_a_worker_that_hangs_is_ended_with_a_traceback_though_nothing_can_run_in_it():
    ended = subprocess.run([sys.executable, "-c", HANGS], capture_output=True, text=True, timeout=DEADLINE)
    assert (ended.returncode, ended.stdout) == (1, "alive\n")
    assert "line 10 in <module>" in ended.stderr


@pytest.mark.parametrize(
    "error", [RecursionError("too deep"), TypeError("a date"), MemoryError(), OSError(7, "too long")]
)
def test_whatever_a_hand_in_makes_of_the_grader_is_its_own_row(error, folder, monkeypatch):
    def fails(*_):
        raise error

    monkeypatch.setattr(worker, "open_sandbox", lambda *_: None)
    monkeypatch.setattr(worker, "prepare_submission", fails)
    monkeypatch.setattr(worker, "_scratch", lambda: None)
    guard = MagicMock()
    monkeypatch.setattr(worker, "ended_if_it_hangs", guard)
    monkeypatch.setenv("ROBOCOP_STATE", "/nowhere")
    monkeypatch.setenv("ROBOCOP_SHARE", "/nowhere")
    (folder / "anna" / "old.rar").touch()
    anna = pack(folder / "anna")
    done = worker.work(worker.Task(anna, PLAN))
    guard.assert_called_once_with(worker.LONGEST)
    report = json.loads(done.files["report.json"])
    assert report["checks"] == [] and type(error).__name__ in report["problems"][0]
    assert report["problems"][1:] == ["old.rar was not unpacked: expected zip or tar"], "it may be what was meant"
