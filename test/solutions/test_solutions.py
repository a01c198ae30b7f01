"""The judge judged: right solutions get full marks, each wrong one fails the check meant for it, with the right words.

A selection of them; `./robocop test --all` has them all.
"""

import os
import socket
import subprocess

import attacks
import pytest
from graded import PLAN, RIGHT, SHARE, STATE, graded, recorded
from wrong_solutions import WRONG

from aro_robocop_goto_as.errors import GradingError
from aro_robocop_goto_as.grading import sandbox
from aro_robocop_goto_as.grading.judge import Outcome

SOME_RIGHT = ("base_server", "base_bridge", "timer_driven_class")
SOME_WRONG = ("misspelt_name", "not_wrapped", "handouts_double_state", "bridge_never_cancels")
BUDGET = 60.0  # [s, wall] for an attack's two scenarios
pytestmark = pytest.mark.xdist_group("hosting")  # they build upon the same workspaces as those who host packages


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
    done = command("robocop_grade.py", str(SHARE), "--report", str(tmp_path))
    assert done.returncode == 0, done.stdout + done.stderr
    assert "9 of 8 points" in done.stdout


def test_the_skeleton_builds_and_is_told_what_lacks_and_the_report_is_one_file(tmp_path):
    made = command("robocop_new.py", str(tmp_path / "lab"))
    assert made.returncode == 0, made.stderr
    done = command("robocop_grade.py", str(tmp_path / "lab"), "--report", str(tmp_path / "report"))
    assert done.returncode == 1
    assert "no action server was created, or it was not started" in done.stdout, done.stdout + done.stderr
    html = (tmp_path / "report" / "report.html").read_text()
    assert "<svg" in html and "http" not in html and "src=" not in html
    assert {path.name for path in (tmp_path / "report").iterdir()} >= {"report.json", "junit.xml", "server-start.bag"}
    assert command("robocop_new.py", str(tmp_path / "lab")).returncode == 1


def attacked(code, folder):
    """The base with an attack in it, in its first scenario: the record of its output, and what cut it short."""
    text = RIGHT["base_server"].read_text()
    names = f"PLAN, FOLDER, PID = {str(PLAN)!r}, {str(folder)!r}, {os.getpid()}\n"
    text = text.replace("if __name__", f"{names}{code}\nif __name__")
    it = recorded(text, folder, only=("left",), budget=BUDGET)
    lines = [line.text for record in it.records.values() for line in record.lines]
    assert not [line for line in lines if "SUCCESS" in line]
    return it, lines


@pytest.mark.parametrize("name", ["FORK_BOMB", "FULL_DISK", "READ", "KILL_ALL", "FORGE", "GIGABYTE_OF_LOG"])
def test_an_attack_comes_to_nothing_and_the_solution_is_graded_all_the_same(name, tmp_path):
    neighbour = tmp_path / "neighbour"
    neighbour.mkdir()
    (neighbour / "solution.py").write_text("secret")
    it, _ = attacked(getattr(attacks, name), tmp_path / "mine")
    assert it.problem == ""
    assert "left" in it.records or not it.records["start"].up, "judged, whatever the node came to"


def test_no_port_outside_is_reached(tmp_path):
    with socket.socket() as outside:
        outside.bind(("127.0.0.1", 0))
        outside.listen()
        _, lines = attacked(attacks.OUTSIDE.replace("PORT", str(outside.getsockname()[1])), tmp_path / "mine")
    assert sum("refused" in line for line in lines) == 3


def test_an_endless_loop_is_a_fail_with_a_reason(tmp_path):
    it, _ = attacked(attacks.ENDLESS, tmp_path / "mine")
    assert not it.records["start"].up


def test_who_kills_the_master_and_the_grader_loses_and_the_reason_is_said(tmp_path):
    it, _ = attacked(attacks.KILL_MASTER, tmp_path / "mine")
    assert it.problem.startswith(("the run was cut short during", "time-out"))


def test_without_bubblewrap_grading_is_refused_unless_it_is_asked_for(tmp_path, monkeypatch):
    monkeypatch.setenv("PATH", str(tmp_path))
    with pytest.raises(GradingError, match="bubblewrap is not installed; --unsafe runs the submission without it"):
        sandbox.cage(False)
    assert sandbox.cage(True) is None


def test_every_solution_is_told_apart_by_its_name():
    assert len({wrong.name for wrong in WRONG}) == len(WRONG) >= 40
    assert len(RIGHT) >= 10
    assert STATE.is_dir()
