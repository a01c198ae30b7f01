"""Simulated time may pass only while the submission's threads sleep."""

import subprocess
import sys
import time

import pytest

from aro_robocop_goto_as.grading.probe import thread_activity

PATIENCE = 60.0  # [s, wall]
SLEEPS = "import threading, sys\nprint('up', flush=True)\nsys.stdin.read()\n"
WORKS = "import threading\ndef work():\n    while True:\n        pass\nprint('up', flush=True)\nwork()\n"
MANY_THREADS = (
    "import threading, sys\nfor _ in range(20):\n    threading.Thread(target=sys.stdin.read, daemon=True).start()\n"
    "print('up', flush=True)\nthreading.Event().wait()\n"
)
SLEEPS_BRIEFLY = "import time\nprint('up', flush=True)\nwhile True:\n    time.sleep(0.001)\n"
CHILD_WORKS = f"import subprocess, sys\nsubprocess.run([sys.executable, '-c', {WORKS!r}])\n"


@pytest.fixture
def started():
    """Starts Python programs and ends them; returns when they have printed a line."""
    processes = []

    def start(code):
        process = subprocess.Popen([sys.executable, "-c", code], stdin=subprocess.PIPE, stdout=subprocess.PIPE)
        processes.append(process)
        assert process.stdout.readline() == b"up\n"
        return process.pid

    yield start
    for process in processes:
        for pid in thread_activity.tree([process.pid])[1:]:
            subprocess.run(["kill", "-KILL", str(pid)], check=False)
        process.kill()
        process.communicate()


def comes_to_rest(pid):
    """Whether a process and its children come to rest within a second or two of looking."""
    deadline, threads = time.monotonic() + PATIENCE, thread_activity.Threads()
    for _ in range(50):
        if threads.at_rest(thread_activity.tree([pid])):
            return True
        if time.monotonic() > deadline:
            break
        time.sleep(0.02)
    return False


def test_process_that_waits_is_at_rest(started):
    assert comes_to_rest(started(SLEEPS))


@pytest.mark.parametrize("code", [WORKS, CHILD_WORKS])
def test_process_that_works_or_has_a_child_that_does_is_not(code, started):
    assert not comes_to_rest(started(code))


def test_process_that_has_ended_is_at_rest():
    process = subprocess.Popen([sys.executable, "-c", ""])
    process.wait(PATIENCE)
    assert thread_activity.tree([process.pid]) == []
    assert thread_activity.Threads().at_rest([process.pid])


def test_process_with_more_threads_than_files_may_be_open_comes_to_rest(started, monkeypatch):
    monkeypatch.setattr(thread_activity, "MOST_OPEN", 5)
    assert comes_to_rest(started(MANY_THREADS))


def test_thread_that_wakes_up_between_two_looks_is_not_at_rest(started, monkeypatch):
    pid, threads = started(SLEEPS_BRIEFLY), thread_activity.Threads()
    busy = threads._busy
    monkeypatch.setattr(threads, "_busy", lambda found: busy(found) or time.sleep(0.1) or False)
    assert not threads.at_rest([pid])
