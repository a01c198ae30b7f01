"""No command replaces what it did not make: a path that a user gives is new, empty, or has the command's stamp."""

import signal
import sys
from pathlib import Path

import pytest
from support import ROOT

from aro_robocop_goto_as.cli import commands
from aro_robocop_goto_as.errors import RobocopError
from aro_robocop_goto_as.own_path import expect_own
from aro_robocop_goto_as.process.signals import ENDING_SIGNALS
from robocop_grading import cli, new
from robocop_grading.classroom import main as classroom


@pytest.fixture(autouse=True)
def signal_handlers():
    """Restore the handlers that the commands replace: what another test starts would inherit ignored signals."""
    before = {number: signal.getsignal(number) for number in ENDING_SIGNALS}
    yield
    for number, handler in before.items():
        signal.signal(number, handler)


def program(main, *words):
    """A command of the package; exits with what it would print, or with its exit status."""

    def run(path, monkeypatch):
        monkeypatch.setattr(sys, "argv", ["robocop", *(word.replace("PATH", str(path)) for word in words)])
        main()

    return run


def record(path, monkeypatch):
    commands.record([str(path)])


GRADE = program(cli.main, "class/novak", "--report", "PATH")
GRADE_CLASS = program(classroom.main, "class", "--report", "PATH")
# Each command that writes to a path of a user, with paths at which there is something else.
COMMANDS = {
    "grade": (GRADE, ["notes", "notes/notes.txt", "class/novak", "class/novak/report", "class", "new/../class/novak"]),
    "grade-class": (GRADE_CLASS, ["notes", "notes/notes.txt", "class", "class/results", "class/novak", ".", ".."]),
    "new": (program(new.main, "PATH"), ["notes", "notes/notes.txt"]),
    "new --gradescope": (program(new.main, "PATH", "--gradescope"), ["notes/lab"]),
    "record": (record, ["notes/run", "notes/run.bag", "notes/killed"]),
}


@pytest.mark.parametrize("run, path", [(run, path) for run, paths in COMMANDS.values() for path in paths])
def test_command_refuses_a_path_with_something_else_in_a_line_and_changes_nothing(
    run, path, tmp_path, monkeypatch, capsys
):
    top = tmp_path / "top"
    for name in ("notes/notes.txt", "notes/lab.zip", "notes/run.bag", "notes/killed.bag.active", "class/novak/a.py"):
        (top / name).parent.mkdir(parents=True, exist_ok=True)
        (top / name).write_text("of the user")
    before = {it: it.is_file() and it.read_text() for it in tmp_path.rglob("*")}
    monkeypatch.chdir(top)
    monkeypatch.setenv("ROBOCOP_STATE", str(top / ".robocop"))
    monkeypatch.setenv("ROBOCOP_SHARE", ROOT)
    with pytest.raises((SystemExit, RobocopError)) as refused:
        run(path, monkeypatch)
    code = getattr(refused.value, "code", None)
    told = capsys.readouterr().err or str(refused.value)
    assert code != 0 and len(told.splitlines()) == 1
    assert any(why in told for why in ("exists", "has other files in it", "neither in it nor around it"))
    assert {it: it.is_file() and it.read_text() for it in tmp_path.rglob("*")} == before


def test_folder_that_is_new_or_empty_or_of_this_command_can_be_written_to(tmp_path):
    expect_own(tmp_path / "new", "stamp", tmp_path / "source")
    expect_own(tmp_path, "stamp")
    (tmp_path / "stamp").touch()
    (tmp_path / "report.html").touch()
    expect_own(tmp_path, "stamp")
    with pytest.raises(RobocopError, match="has other files in it"):
        expect_own(tmp_path, "another")
    (tmp_path / "link").symlink_to(Path("nowhere"))
    with pytest.raises(RobocopError, match="link exists"):
        expect_own(tmp_path / "link", "stamp")
