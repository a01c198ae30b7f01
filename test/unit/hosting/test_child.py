"""Child processes end with all their descendants, at once or after a grace period."""

import os
import signal
import subprocess
import sys

import pytest

from robocop_hosting import child

DEADLINE = 30.0  # [s, wall]


@pytest.fixture
def alive():
    """A pipe to pass to children: it reads as ended once every holder has ended."""
    ended, alive = os.pipe()
    yield ended, alive
    os.close(ended)


def shell(script, alive, **options):
    """A shell that prints "ready" once `script`, which must print it, has started its own children."""
    started = child.start(["sh", "-c", script], pass_fds=[alive[1]], stdout=subprocess.PIPE, **options)
    os.close(alive[1])
    assert started.stdout.readline() == b"ready\n"
    return started


@pytest.mark.parametrize(
    "script",
    [
        "sleep 600 & echo ready; wait",
        "(sleep 600 &); echo ready; sleep 600",
        "trap '' TERM; sleep 600 & echo ready; sleep 600; sleep 600",
        "setsid sh -c 'sleep 600 & echo ready; wait' & wait",
        "setsid sh -c 'trap \"\" TERM; echo ready; sleep 600' & wait",
    ],
)
def test_end_leaves_no_descendants(script, alive):
    started = shell(script, alive)
    assert child.end(started, grace=0.5) in (-signal.SIGTERM, -signal.SIGKILL)
    assert os.read(alive[0], 1) == b""


def test_a_child_may_clean_up_within_its_grace_period(alive):
    started = shell("trap 'exit 7' INT; echo ready; while :; do sleep 0.01; done", alive)
    assert child.end(started, signal.SIGINT, DEADLINE) == 7


def test_a_process_that_keeps_starting_others_is_killed_with_all_of_them(alive):
    started = shell("echo ready; while :; do setsid sleep 600 & done", alive)
    child.kill_tree(started.pid)
    assert started.wait(DEADLINE) == -signal.SIGKILL
    assert os.read(alive[0], 1) == b""


def test_output_and_errors_go_to_the_log(tmp_path):
    log = tmp_path / "log"
    started = child.start(
        [sys.executable, "-c", "import os, sys; print(os.environ['WORD'], os.getcwd()); sys.exit('failed')"],
        log,
        {**os.environ, "WORD": "word"},
        tmp_path,
    )
    assert child.end(started, None, DEADLINE) == 1
    assert sorted(log.read_text().splitlines()) == ["failed", f"word {tmp_path}"]
