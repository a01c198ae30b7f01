"""A process is idle only while none of its threads runs or wants to, whatever load the machine has."""

import os
import signal
import subprocess
import sys

import psutil
import pytest
from waiting import wait_for

from robocop_grading.sandbox import stillness
from robocop_grading.sandbox.stillness import Stillness

ENOUGH = 0.5  # [s, wall]


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
    [
        "import time; time.sleep(600)",
        "import subprocess; subprocess.run(['sleep', '60'])",
        "import time\nfrom threading import Thread\ndef run():\n    while True: time.sleep(0.01)\n"
        "Thread(target=run).start()\nrun()",
    ],
)
def test_process_that_sleeps_again_and_again_with_its_threads_and_children_is_idle(code, started):
    watched = Stillness(started(code).pid)
    wait_for(lambda: watched.look() > ENOUGH, "idle")


def test_stopped_process_is_idle(started):
    process = started("while True: pass")
    os.kill(process.pid, signal.SIGSTOP)
    watched = Stillness(process.pid)
    wait_for(lambda: watched.look() > ENOUGH, "idle")


def test_process_that_computes_is_not_idle_whatever_else_the_processor_does(started):
    code = "import os\nos.sched_setaffinity(0, {min(os.sched_getaffinity(0))})\nwhile True: pass"
    first, *others = (started(code) for _ in range(3))
    watched = Stillness(first.pid)
    wait_for(lambda: watched.look() > ENOUGH or psutil.Process(first.pid).cpu_times().user > 0.3, "has run")
    assert watched.idle < ENOUGH
