"""All descendants of a process are killed, wherever they are, and children end with their parent."""

import subprocess
import sys

import pytest

DEADLINE = 120.0  # [s, wall]
# Every descendant holds the pipe open, so it reads as ended once none is left.
ENDED = """
import os, subprocess
from aro_robocop_goto_as.process import orphans
orphans.adopt_orphans()
ended, alive = os.pipe()
subprocess.Popen(["sh", "-c", {family!r}], pass_fds=[alive], env={{"PATH": os.environ["PATH"], "SLEEP": "sleep 600"}})
os.close(alive)
orphans.kill_descendants()
assert os.read(ended, 1) == b""
"""


@pytest.mark.parametrize(
    "family",
    [
        "$SLEEP >&2",
        "trap '' TERM INT HUP; $SLEEP & wait; $SLEEP",
        "$SLEEP & $SLEEP & exit",
        "setsid -f $SLEEP",
        "setsid -f env -i sh -c 'sleep 600 & setsid -f sleep 600; sleep 600'",
        "for i in 1 2 3 4 5 6 7 8; do setsid -f sh -c '(setsid -f sleep 600) & sleep 600'; done",
    ],
)
def test_no_descendant_survives(family):
    assert subprocess.run([sys.executable, "-c", ENDED.format(family=family)], timeout=DEADLINE).returncode == 0


def test_adopted_child_that_has_ended_is_let_go_of():
    code = """
import psutil, subprocess, time
from aro_robocop_goto_as.process import orphans
orphans.adopt_orphans()
own = subprocess.Popen(["true"])
subprocess.run(["sh", "-c", "sleep 0 & exit"])
this = psutil.Process()
while [child.status() for child in this.children()] != 2 * [psutil.STATUS_ZOMBIE]:
    time.sleep(0.01)
orphans.reap_adopted("sleep")
assert [child.pid for child in this.children()] == [own.pid]
"""
    assert subprocess.run([sys.executable, "-c", code], timeout=DEADLINE).returncode == 0


# The child kills its parent, which handles SIGTERM in Python, before or after it has asked for the signal, then execs.
KILLED = """
import os, signal, subprocess
from aro_robocop_goto_as.process import orphans
signal.signal(signal.SIGTERM, lambda *_: None)
parent, end = os.getpid(), orphans.end_with_parent()

def lose_parent():
    os.kill(parent, signal.SIGKILL)
    while os.getppid() == parent:
        pass

def between_fork_and_exec():
    for step in ({steps}):
        step()

subprocess.Popen(["sleep", "600"], preexec_fn=between_fork_and_exec)
"""


@pytest.mark.parametrize("steps", ["lose_parent, end", "end, lose_parent"])
def test_child_ends_with_a_parent_that_is_killed_while_it_starts_the_child(steps):
    command = [sys.executable, "-c", KILLED.format(steps=steps)]
    # The child holds the pipe open.
    assert subprocess.run(command, stdout=subprocess.PIPE, timeout=DEADLINE).stdout == b""
