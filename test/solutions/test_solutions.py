"""The judge judged: right solutions get full marks, each wrong one fails the check meant for it, with the right words.

A selection of them; `./robocop test --all` has them all.
"""

import os
import signal
import subprocess
import time

import pytest
from graded import RIGHT, SHARE, STATE, SWITCHES, graded
from processes import processes_with
from wrong_solutions import WRONG

from aro_robocop_goto_as.errors import GradingError
from aro_robocop_goto_as.grading import sandbox
from aro_robocop_goto_as.grading.judge import Outcome
from aro_robocop_goto_as.grading.main import INTERRUPTED

SOME_RIGHT = ("base_server", "base_bridge", "functions_bang_bang")
SOME_WRONG = ("misspelt_name", "not_wrapped", "handouts_double_state", "bridge_never_cancels")


def pytest_generate_tests(metafunc):
    everything = metafunc.config.getoption("--all")
    if "right" in metafunc.fixturenames:
        metafunc.parametrize("right", RIGHT if everything else SOME_RIGHT)
    if "wrong" in metafunc.fixturenames:
        chosen = [wrong for wrong in WRONG if everything or wrong.name in SOME_WRONG]
        metafunc.parametrize("wrong", chosen, ids=lambda wrong: wrong.name)


def test_a_right_solution_gets_full_marks(right, tmp_path):
    grade = graded(right, RIGHT[right].read_text(), tmp_path)
    assert {line.name: line.words() for line in grade.lines if line.outcome is not Outcome.PASSED} == {}


def test_a_wrong_solution_fails_the_check_meant_for_it_with_the_right_words(wrong, tmp_path):
    grade = graded(wrong.name, wrong.text(), tmp_path)
    line = next(line for line in grade.lines if line.name == wrong.check)
    assert line.outcome is Outcome.FAILED, line.words()
    assert wrong.words in line.words()


def command(*arguments):
    """`robocop grade` or `robocop new` in this workspace."""
    return subprocess.run(["rosrun", "aro_robocop_goto_as", *arguments], capture_output=True, text=True, timeout=250)


def test_the_reference_gets_full_marks_and_the_extra_point(tmp_path):
    done = command("robocop_grade.py", str(SHARE), "--report", str(tmp_path), *SWITCHES)
    assert done.returncode == 0, done.stdout + done.stderr
    assert "9 of 8 points" in done.stdout


def test_the_skeleton_builds_and_is_told_what_lacks_and_the_report_is_one_file(tmp_path):
    made = command("robocop_new.py", str(tmp_path / "lab"))
    assert made.returncode == 0, made.stderr
    done = command("robocop_grade.py", str(tmp_path / "lab"), "--report", str(tmp_path / "report"), *SWITCHES)
    assert done.returncode == 1
    assert "no action server was created, or it was not started" in done.stdout, done.stdout + done.stderr
    html = (tmp_path / "report" / "report.html").read_text()
    assert "<svg" in html and "http" not in html and "src=" not in html
    assert {path.name for path in (tmp_path / "report").iterdir()} >= {"report.json", "junit.xml", "server-start.bag"}
    assert command("robocop_new.py", str(tmp_path / "lab")).returncode == 1


@pytest.mark.parametrize("numbers", [[signal.SIGINT], [signal.SIGTERM, signal.SIGTERM], [signal.SIGHUP, signal.SIGINT]])
def test_ended_on_its_way_it_leaves_neither_folders_nor_processes(numbers, tmp_path):
    solution, scratch = tmp_path / "robocop_goto_as.py", tmp_path / "scratch"
    solution.write_text(RIGHT["base_server"].read_text())
    scratch.mkdir()
    with open(tmp_path / "output", "w") as output:
        grading = subprocess.Popen(
            ["rosrun", "aro_robocop_goto_as", "robocop_grade.py", str(solution), *SWITCHES], stdout=output,
            stderr=output, env={**os.environ, "TMPDIR": str(scratch)})
    deadline = time.monotonic() + 60.0
    while not list(scratch.glob("**/server-start.json")):  # the first scenario is over, the second has begun
        assert grading.poll() is None and time.monotonic() < deadline, (tmp_path / "output").read_text()
        time.sleep(0.01)
    for number in numbers:
        grading.send_signal(number)
    assert grading.wait(60.0) == INTERRUPTED, (tmp_path / "output").read_text()
    assert "Traceback" not in (tmp_path / "output").read_text()
    assert list(scratch.iterdir()) == []
    assert processes_with(b"TMPDIR=" + os.fsencode(scratch)) == []


def test_without_bubblewrap_grading_is_refused_unless_it_is_asked_for(tmp_path, monkeypatch):
    monkeypatch.setenv("PATH", str(tmp_path))
    with pytest.raises(GradingError, match="bubblewrap is not installed; --unsafe runs the submission without it"):
        sandbox.cage(False)
    assert sandbox.cage(True) is None


def test_every_solution_is_told_apart_by_its_name():
    assert len({wrong.name for wrong in WRONG}) == len(WRONG) >= 40
    assert len(RIGHT) >= 10
    assert STATE.is_dir()
