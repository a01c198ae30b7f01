"""The temporary folder of grade, grade-class and sim --with is removed with its program."""

import os
import signal
import subprocess
import sys
import time

import pytest
from processes import busy_processes, processes_mentioning

SCRATCH_PROGRAM = """
import subprocess, sys, time
from robocop_hosting.scratch import scratch_folder
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
def test_a_program_and_its_children_leave_no_temporary_files(number, tmp_path):
    command = [sys.executable, "-c", SCRATCH_PROGRAM, "end" if number is None else "sleep"]
    program = subprocess.Popen(command, env={**os.environ, "TMPDIR": str(tmp_path)})
    try:
        if number is not None:
            deadline = time.monotonic() + 60.0
            while not list(tmp_path.glob("robocop-temporary-*/tmp.*")):
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
