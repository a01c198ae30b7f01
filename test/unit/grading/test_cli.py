"""robocop grade: where a report goes, which checks run, and what each exit status means."""

import errno
from pathlib import Path

import pytest
from support import ROOT

from robocop_grading import cli
from robocop_grading.errors import GradingError, PlanError, UngradableError
from robocop_hosting.errors import HostingError

REPORTS = Path("/reports")


@pytest.mark.parametrize(
    "given, folder",
    [
        ("novak", "novak"),
        ("../hand_ins/svoboda/", "hand_ins/svoboda"),
        ("novak/robocop_goto_as.py", "novak/robocop_goto_as.py"),
        ("/tmp/novak/lab.zip", "tmp/novak/lab.zip"),
        (".", "here"),
    ],
)
def test_report_is_named_after_what_was_given(given, folder, tmp_path, monkeypatch):
    (tmp_path / "here").mkdir()
    monkeypatch.chdir(tmp_path / "here")
    assert cli.report_folder(REPORTS, given) == REPORTS / folder


def status(error, tmp_path, monkeypatch, capsys, *arguments, path="lab"):
    """The exit status of a grading that ends with an error, or None to let it begin; and what it prints."""

    def fail(*_):
        raise error

    monkeypatch.setenv("ROBOCOP_STATE", str(tmp_path))
    monkeypatch.setenv("ROBOCOP_SHARE", ROOT)
    monkeypatch.setattr("sys.argv", ["robocop_grade.py", path, *arguments])
    if error is not None:
        monkeypatch.setattr(cli, "open_sandbox", fail)
    with pytest.raises(SystemExit) as ended:
        cli.main()
    return ended.value.code, capsys.readouterr().err


@pytest.mark.parametrize(
    "error, expected",
    [
        (PlanError("the plan"), 2),
        (UngradableError("no time"), 3),
        (GradingError("no server"), 4),
        (HostingError("no package"), 4),
        (ZeroDivisionError("a mistake of the grader"), 3),
    ],
)
def test_exit_status_says_who_can_correct_what(error, expected, tmp_path, monkeypatch, capsys):
    assert status(error, tmp_path, monkeypatch, capsys)[0] == expected


def test_a_full_disk_does_not_make_an_error_of_the_grader_a_grade(tmp_path, monkeypatch, capsys):
    def full(_args):
        raise OSError(errno.ENOSPC, "No space left on device")

    monkeypatch.setattr(cli, "_kept_traceback", full)
    code, printed = status(ZeroDivisionError(), tmp_path, monkeypatch, capsys)
    assert code == 3 and "could not be graded: ZeroDivisionError()" in printed


@pytest.mark.parametrize(
    "arguments, told",
    [
        (["--only", "cancel,next_goal,nosuch"], "robocop grade: --only nosuch: "),
        (["--plan", "/no/such.yaml"], "robocop grade: /no/such.yaml: can't be read"),
        (["--report", "/proc/here"], "robocop grade: the report can't be written to /proc/here: "),
        (["--seed", "-1"], "robocop grade: --seed -1: expected a number from 0"),
    ],
)
def test_value_that_is_wrong_is_named(arguments, told, tmp_path, monkeypatch, capsys):
    code, printed = status(None, tmp_path, monkeypatch, capsys, *arguments)
    assert code == 2 and printed.startswith(told) and printed.count("/no/such.yaml") <= 1
    assert printed.count("\n") == 1


def test_submission_that_is_not_there_is_told(tmp_path, monkeypatch, capsys):
    (tmp_path / "circle").symlink_to("circle")
    for path in ("nowhere", "circle"):
        code, printed = status(None, tmp_path, monkeypatch, capsys, "--unsafe", path=str(tmp_path / path))
        assert (code, printed.count("\n")) == (4, 1) and f"{path}: expected a folder, an archive (zip" in printed
