"""A process is still only if none of its threads runs or wants to, which has nothing to do with the machine's load."""

import os
import signal
import subprocess
import sys

import pytest
from waiting import wait_for

from robocop_grading.sandbox import stillness
from robocop_grading.sandbox.stillness import Stillness

ENOUGH = 5  # looks


@pytest.fixture(autouse=True)
def _often(monkeypatch):
    monkeypatch.setattr(stillness, "LOOK", 0.05)


@pytest.fixture
def started():
    """A process that runs a program, which prints a line when it is ready."""
    processes = []

    def start(code):
        process = subprocess.Popen([sys.executable, "-c", f"print(1, flush=True)\n{code}"], stdout=subprocess.PIPE)
        processes.append(process)
        process.stdout.readline()
        return process

    yield start
    for process in processes:
        process.kill()
        process.stdout.close()
        process.wait()


@pytest.mark.parametrize(
    "code",
    ["import time; time.sleep(600)", "import subprocess; subprocess.run(['sleep', '60'])"],
)
def test_process_that_sleeps_is_still_with_its_children(code, started):
    watched = Stillness(started(code).pid)
    wait_for(lambda: watched.look() >= ENOUGH, "still")


def test_stopped_process_is_still(started):
    process = started("while True: pass")
    os.kill(process.pid, signal.SIGSTOP)
    watched = Stillness(process.pid)
    wait_for(lambda: watched.look() >= ENOUGH, "still")


def test_process_that_runs_now_and_then_is_not_still_and_is_seen_to_run(started):
    watched = Stillness(started("import time\nwhile True: time.sleep(0.005)").pid)
    most = 0

    def has_run():
        nonlocal most
        most = max(most, watched.look())
        return watched.switches > 100

    wait_for(has_run, "has run")
    assert most == 0


def test_thread_that_is_spared_may_run_now_and_then_and_a_second_one_not(started):
    code = "import time\nfrom threading import Thread\ndef run():\n    while True: time.sleep(0.005)\n"
    watched = Stillness(started(f"{code}run()").pid, spare=1)
    wait_for(lambda: watched.look() >= ENOUGH, "still")
    watched = Stillness(started(f"{code}Thread(target=run).start()\nrun()").pid, spare=1)
    wait_for(lambda: watched.look() or watched.switches > 50, "seen to run")
    assert watched.looks == 0
