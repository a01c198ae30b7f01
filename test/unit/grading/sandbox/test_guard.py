"""The guard kills a process tree that exceeds its limit, says why, and counts shared memory once."""

import os
import subprocess
import sys
from pathlib import Path

import psutil
import pytest

from aro_robocop_goto_as.errors import GradingError
from aro_robocop_goto_as.process.child import kill_tree
from robocop_grading.sandbox import kernel_memory
from robocop_grading.sandbox.bubblewrap import open_sandbox
from robocop_grading.sandbox.guard import Guard

MB = 1024**2
PATIENCE = 120.0  # [s, wall]
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


# Each kind of sockets that keep what is sent to them; connections that nobody accepts belong to no process.
PARKED = """
import socket, sys, time
def fill(one):
    one.setblocking(False)
    try:
        while True:
            one.send(bytes(2 ** 16))
    except OSError:
        one.setblocking(True)
kind, number = sys.argv[1], int(sys.argv[2])
family = socket.AF_INET if kind == "tcp" else socket.AF_UNIX
listener = socket.socket(family)
listener.bind(("127.0.0.1", 0) if kind == "tcp" else "")
listener.listen(1000)
kept = []
for _ in range(number):
    if kind == "pairs":
        kept += socket.socketpair()
        fill(kept[-1])
    else:
        one = socket.socket(family)
        one.connect(listener.getsockname())
        fill(one)
        kept.append(one if kind == "tcp" else one.close())
time.sleep({alive})
"""
EMPTY_FILES = """
import os, sys, time
for number in range(int(sys.argv[1])):
    os.close(os.open(f"/dev/shm/{number}", os.O_CREAT | os.O_WRONLY))
time.sleep({alive})
"""


def watched(code, folder=None, command=None, **limits):
    """A guarded program: its exit status and the guard's reason."""
    process = subprocess.Popen(command or [sys.executable, "-c", code], start_new_session=True, cwd=folder)
    guard = Guard(process.pid, folder, **limits)
    try:
        return process.wait(PATIENCE), guard.reason
    finally:
        guard.stop()
        if process.poll() is None:
            kill_tree(process.pid)
            process.wait()


def test_processes_that_together_exceed_the_memory_limit_are_killed():
    status, reason = watched(FAMILY.format(shared=1, own=60, alive=600.0), memory=200 * MB)
    assert status < 0
    assert reason == "its processes together took more than 200 MB of memory"


def test_too_many_processes_are_killed():
    fork = "import os, time\nfor _ in range(100):\n    os.fork() or time.sleep(60)\ntime.sleep(60)"
    _, reason = watched(fork)
    assert reason == "it started more than 64 processes"


def test_processor_time_of_all_processes_together_is_limited():
    _, reason = watched("import os\nos.fork()\nwhile True: pass", processor_time=1.0)
    assert reason == "its processes together used more than 1 s of processor time"


def test_shared_memory_counts_once(tmp_path):
    code = FAMILY.format(shared=100, own=1, alive=1.0) + "os.killpg(0, 15)"
    assert watched(code, memory=250 * MB)[1] == ""


def test_a_process_whose_folder_grows_too_large_is_killed(tmp_path):
    code = "import time\nopen('big', 'wb').write(bytes(5 * 2 ** 20))\ntime.sleep(600.0)"
    status, reason = watched(code, tmp_path, disk=4 * MB)
    assert status < 0
    assert reason == "it wrote more than 4 MB"


@pytest.mark.parametrize("code", ["", "raise SystemExit(3)"])
def test_process_that_ends_by_itself_is_reported_without_a_reason(code):
    status, reason = watched(code)
    assert (status, reason) == (3 if code else 0, "")


@pytest.mark.parametrize("kind", ["pairs", "unaccepted", "tcp"])
@pytest.mark.parametrize("place", ["node", "build"])
@pytest.mark.parametrize("number, alive, reason", [(110, 600.0, True), (5, 0.5, False)])
def test_what_sockets_can_hold_counts_as_memory(kind, place, number, alive, reason, tmp_path):
    assert bool(in_sandbox(PARKED.replace("{alive}", str(alive)), place, tmp_path, kind, number)) == reason


def test_tables_of_connections_are_read_only_for_the_exact_number(monkeypatch):
    monkeypatch.setenv(kernel_memory.OUTER_NETWORK, "1")  # another one than this process's
    monkeypatch.setattr(kernel_memory, "_queued", lambda _table: 10**15)
    assert [kernel_memory.total([psutil.Process()], exact) > 10**15 for exact in (False, True)] == [False, True]


@pytest.mark.parametrize("place", ["node", "build"])
@pytest.mark.parametrize("number, alive, reason", [(100_000, 600.0, True), (100, 0.5, False)])
def test_empty_files_in_memory_count(place, number, alive, reason, tmp_path):
    assert bool(in_sandbox(EMPTY_FILES.replace("{alive}", str(alive)), place, tmp_path, number)) == reason


def in_sandbox(code, place, folder, *arguments):
    """The guard's reason for ending a program that runs as a node or a build, if it did."""
    try:
        sandbox = open_sandbox(False)
    except GradingError as error:
        pytest.skip(str(error))
    command = ["/usr/bin/python3", "-c", code, *map(str, arguments)]
    if place == "node":
        command = sandbox.probe_command(sandbox.node_command(command, {}, (), Path("/tmp/home")))
    else:
        os.chmod(folder, 0o777)
        command = sandbox.build_command(command, {}, (), folder)
    status, why = watched("", command=command, memory=70 * MB)
    assert bool(why) == (status != 0)
    return why
