"""The guard kills a process tree that exceeds its limit, says why, and counts shared memory once."""

import subprocess
import sys

import pytest

from robocop_grading.sandbox.guard import Guard
from robocop_hosting.child import kill_tree

MB = 1024**2
TIMEOUT = 120.0  # [s, wall]
# Children that allocate memory of their own, besides what they share with their parent, and then sleep.
FAMILY = """
import os, time
shared = bytearray({shared} * 2 ** 20)
for _ in range(4):
    if os.fork() == 0:
        own = bytearray({own} * 2 ** 20)
        time.sleep(600.0)
time.sleep({alive})
"""


def watched(code, **limits):
    """A guarded program: its exit status and the guard's reason."""
    process = subprocess.Popen([sys.executable, "-c", code], start_new_session=True)
    guard = Guard(process.pid, **limits)
    try:
        return process.wait(TIMEOUT), guard.reason
    finally:
        guard.stop()
        if process.poll() is None:
            kill_tree(process.pid)
            process.wait()


@pytest.mark.parametrize(
    "code, limits, reason",
    [
        (FAMILY.format(shared=1, own=60, alive=600.0), {"memory": 200 * MB}, "took more than 200 MB of memory"),
        (
            "import os, time\nfor _ in range(100):\n    os.fork() or time.sleep(60)\ntime.sleep(60)",
            {},
            "it started more than 64 processes",
        ),
        ("import os\nos.fork()\nwhile True: pass", {"processor_time": 1.0}, "used more than 1 s of processor time"),
    ],
)
def test_processes_that_together_exceed_a_limit_are_killed(code, limits, reason):
    status, told = watched(code, **limits)
    assert status < 0 and told.endswith(reason)


def test_shared_memory_counts_once():
    code = FAMILY.format(shared=100, own=1, alive=1.0) + "os.killpg(0, 15)"
    assert watched(code, memory=250 * MB)[1] == ""


def test_process_that_ends_by_itself_is_reported_without_a_reason():
    assert watched("raise SystemExit(3)") == (3, "")
