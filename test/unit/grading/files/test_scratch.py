"""The temporary folder of grade, grade-class and sim --with is removed with its program, or by the next one."""

import os
import signal
import subprocess
import sys
import time
from pathlib import Path
from typing import Optional

import pytest
from processes import busy_processes, processes_mentioning

HOLD = """
import sys, tempfile
from robocop_grading.files.scratch import scratch_folder
with scratch_folder():
    print(tempfile.mkdtemp(), flush=True)
    sys.stdin.read()
"""


def holder(folder):
    """A process in a scratch folder."""
    return subprocess.Popen(
        [sys.executable, "-c", HOLD],
        env={**os.environ, "TMPDIR": str(folder)},
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        text=True,
    )


def test_folder_of_a_killed_process_is_removed_by_the_next_one_but_not_that_of_a_running_one(tmp_path):
    killed, running, following = (holder(tmp_path) for _ in range(3))
    with killed, running, following:
        made = [process.stdout.readline() for process in (killed, running)]
        assert all(made) and following.stdout.readline()
        assert len(list(tmp_path.iterdir())) == 3
        killed.kill()
        killed.wait()
        following.communicate("")
        assert len(list(tmp_path.iterdir())) == 2
        with holder(tmp_path) as last:
            assert last.stdout.readline()
            assert len(list(tmp_path.iterdir())) == 2  # the running one's and its own
            last.communicate("")
        assert os.path.isdir(made[1].strip()) and not os.path.exists(made[0].strip())
        running.communicate("")
    assert list(tmp_path.iterdir()) == []


SCRATCH_PROGRAM = """
import subprocess, sys, time
from robocop_grading.files.scratch import scratch_folder
from aro_robocop_goto_as.process.signals import interrupt_on_signal

interrupt_on_signal()
try:
    with scratch_folder():
        subprocess.Popen(["sh", "-c", "setsid sh -c 'while mktemp >/dev/null; do sleep 0.01; done' & sleep 600"])
        time.sleep(600.0 if sys.argv[1] == "sleep" else 1.0)
except KeyboardInterrupt:
    sys.exit(130)
"""


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM, None])
def test_a_program_and_its_children_leave_no_temporary_files(number: Optional[int], tmp_path: Path) -> None:
    command = [sys.executable, "-c", SCRATCH_PROGRAM, "end" if number is None else "sleep"]
    program = subprocess.Popen(command, env={**os.environ, "TMPDIR": str(tmp_path)})
    try:
        if number is not None:
            deadline = time.monotonic() + 60.0
            while not list(tmp_path.glob("robocop-scratch-*/tmp.*")):
                assert program.poll() is None and time.monotonic() < deadline
                time.sleep(0.01)
            with busy_processes():
                program.send_signal(number)
                program.wait(60.0)
        assert program.wait(60.0) == (0 if number is None else 130)
    finally:
        program.kill()
    assert list(tmp_path.iterdir()) == []
    assert processes_mentioning(tmp_path) == []
