"""A program that crashes is started again, up to three times; one that ends in any other way is not."""

import subprocess
from pathlib import Path

import pytest

SCRIPT = Path(__file__).resolve().parents[2] / "launch" / "restart_after_crash"


@pytest.mark.parametrize(
    ("command", "status", "runs"),
    [
        ("[ $(wc -l < log) = 1 ] && kill -SEGV $$; exit 0", 0, 2),
        ("kill -ABRT $$", 134, 3),
        ("exit 3", 3, 1),
        ("kill -INT $$", 130, 1),
        ("kill -TERM $$", 143, 1),
    ],
)
def test_only_a_program_that_crashed_is_started_again(tmp_path, command, status, runs):
    counted = ["bash", SCRIPT, "bash", "-c", f"echo run >> log; {command}"]
    done = subprocess.run(counted, cwd=tmp_path, stderr=subprocess.PIPE, text=True)
    assert (done.returncode, (tmp_path / "log").read_text().count("run")) == (status, runs)
    assert ("bash crashed (status 1" in done.stderr) == (runs > 1)
