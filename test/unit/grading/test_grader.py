"""A part that was killed is run once more; killed again, it is graded unless the machine may be to blame."""

from dataclasses import replace

import pytest
from grading_records import PLAN, RIGHT, changed

from robocop_grading.errors import UngradableError
from robocop_grading.grader import grade
from robocop_grading.record import Death, Line, Record
from robocop_grading.runner import Recorded, Runner
from robocop_grading.sandbox import guard
from robocop_grading.submission import Script, Submission

DEAD = Record("far", "server", deaths=(Death(1.0, 137),))
KILLED = Recorded({"far": DEAD}, killed="the server was killed in scenario far")
EXCUSED = replace(KILLED, excused=True)
GRADED = Recorded({"start": Record("start", "server", servers=("/other",), types=("",), up=False)})


def graded(outcomes, folder, monkeypatch):
    """The grade of a server whose runs have these outcomes."""
    left = list(outcomes)
    monkeypatch.setattr(Runner, "run", lambda *_: left.pop(0))
    submission = Submission("anna", (), {}, [Script("server", folder / "solution.py")])
    return grade(Runner(PLAN, folder), submission, folder / "report")


def test_killed_part_is_run_again_and_the_grade_says_so(tmp_path, monkeypatch):
    grade = graded([KILLED, GRADED], tmp_path, monkeypatch)
    assert "action_server" in grade.failed(), "by the second run"
    assert grade.notes == (
        "server: the server was killed in scenario far by a SIGKILL that did not come from the grader; this part was "
        "run again",
    )


def test_part_that_is_killed_twice_on_a_machine_short_of_memory_is_not_gradable(tmp_path, monkeypatch):
    reason = r"not gradable: the server was killed in scenario far by a SIGKILL .* \(is the machine short of memory\?\)"
    with pytest.raises(UngradableError, match=reason):
        graded([KILLED, EXCUSED], tmp_path, monkeypatch)


def test_part_that_is_killed_twice_though_the_kernel_has_killed_nothing_is_graded(tmp_path, monkeypatch):
    grade = graded([EXCUSED, KILLED], tmp_path, monkeypatch)
    (death,) = [check for check in grade.checks if check.failure is not None and check.name == "stays_alive"]
    assert "The node died: signal 9 (SIGKILL). " in death.words


def test_the_kernel_tells_how_many_processes_it_has_killed(tmp_path, monkeypatch):
    assert guard.kernel_kills() >= 0
    monkeypatch.setattr(guard, "COUNTERS", tmp_path / "vmstat")
    assert guard.kernel_kills() == 0
    (tmp_path / "vmstat").write_text("pgfault 5\noom_kill 3\nswap_ra 7\n")
    assert guard.kernel_kills() == 3


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
def test_only_a_sigkill_that_the_grader_did_not_send_is_unexplained(death, outside):
    assert death.is_unexplained == outside


@pytest.mark.parametrize(
    "all_plots, bags", [(False, ["server-left.bag"]), (True, ["server-far.bag", "server-left.bag"])]
)
def test_bags_are_kept_of_scenarios_in_which_a_check_failed_unless_all_are_asked_for(
    all_plots, bags, tmp_path, monkeypatch
):
    fast = changed(commands=tuple(replace(it, v=1.0) for it in RIGHT.commands))

    def run(_runner, _submission, _script, out):
        out.mkdir(parents=True)
        for name in ("left", "far"):
            (out / f"server-{name}.bag").touch()
        return Recorded({"left": fast, "far": replace(RIGHT, name="far")})

    monkeypatch.setattr(Runner, "run", run)
    submission = Submission("anna", (), {}, [Script("server", tmp_path, "node")])
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
        ("ropsy", "Python's module ropsy is not installed here; did you mean rospy?"),
        ("mine", "mine.py lies beside solution.py, but only solution.py was given: grade the folder"),
    ],
)
def test_module_that_is_not_installed_is_named_as_mistyped_as_one_of_the_lab_or_as_left_behind(
    module, words, tmp_path, monkeypatch
):
    (tmp_path / "mine.py").touch()
    lines = ["Traceback (most recent call last):", f"ModuleNotFoundError: No module named '{module}'"]
    record = Record("start", "server", up=False, lines=tuple(Line(0.0, line) for line in lines))
    (problem,) = graded([Recorded({"start": record})], tmp_path, monkeypatch).notes
    assert problem == f"server: {words}"
