"""All descendants of a process are killed, wherever they are."""

import subprocess
import sys

import pytest

DEADLINE = 120.0  # [s, wall]
# Every descendant holds the pipe open, so it reads as ended once none is left.
ENDED = """
import os, subprocess
from robocop_hosting import orphans
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
from robocop_hosting import orphans
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
