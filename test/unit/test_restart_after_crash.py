"""A program that crashes is started again, up to three times; one that ends in any other way is not."""

import signal
import subprocess
from pathlib import Path

import pytest

SCRIPT = Path(__file__).resolve().parents[2] / "launch" / "restart_after_crash"
COUNT = "echo run >> log; "


def run(folder, command):
    """The exit status, standard error, and how often the command ran."""
    done = subprocess.run(
        ["bash", SCRIPT, "bash", "-c", COUNT + command], cwd=folder, stderr=subprocess.PIPE, text=True
    )
    return done.returncode, done.stderr, len((folder / "log").read_text().splitlines())


def test_program_that_crashed_once_runs_again(tmp_path):
    status, errors, runs = run(tmp_path, "[ $(wc -l < log) = 1 ] && kill -SEGV $$; exit 0")
    assert (status, runs) == (0, 2)
    assert "bash crashed (status 139) at attempt 1 of 3" in errors


def test_program_that_always_crashes_runs_three_times(tmp_path):
    status, _, runs = run(tmp_path, "kill -ABRT $$")
    assert (status, runs) == (128 + signal.SIGABRT, 3)


@pytest.mark.parametrize("command, expected", [("exit 3", 3), ("kill -INT $$", 130), ("kill -TERM $$", 143)])
def test_program_that_fails_or_is_ended_does_not_run_again(command, expected, tmp_path):
    status, errors, runs = run(tmp_path, command)
    assert (status, runs) == (expected, 1)
    assert "crashed" not in errors
