"""A ROS system on a free port, started for a while and ended with all its processes."""

import contextlib
import os
import sys
import time
from pathlib import Path
from typing import Any, Iterator, List

from ...bootstrap import master
from ...errors import MasterError
from ...process import child, signals, subreaper
from ...process.parent_death import end_with_parent
from ...process.ports import free_port
from ..names import PACKAGE

LAUNCHER = Path(sys.argv[0]).absolute().with_name("robocop_launch.py")  # beside the program that runs
START_PATIENCE = 60.0  # [s, wall] for its master to answer, also on a slow machine
END_PATIENCE = 30.0  # [s, wall] for the system to end; roslaunch itself kills nodes after 17 s
POLL = 0.05  # [s, wall]


@contextlib.contextmanager
def own_system(launch_file: str, arguments: List[str], log: Path) -> "Iterator[child.Child[Any]]":
    """Launch a file of this package with a master of its own; yields its process, which starts. Output goes to `log`.

    Sets ROS_MASTER_URI of this process. The system ends with the block, also when a signal ends the block.
    """
    port = free_port()
    os.environ["ROS_MASTER_URI"] = f"http://localhost:{port}"
    log.parent.mkdir(parents=True, exist_ok=True)
    command = [str(LAUNCHER), "--no-summary", "-p", str(port), PACKAGE, launch_file, *arguments]
    subreaper.adopt_orphans()
    system = None
    try:
        with signals.Deferred():
            system = child.start(command, log, preexec_fn=end_with_parent())  # this thread is the main one
        yield system
    finally:
        signals.begin_cleanup()  # a second Ctrl-C must not leave half of the system behind
        if system is not None:
            child.end(system, grace=END_PATIENCE)
            subreaper.kill_descendants()


def wait_for_master(system: "child.Child[Any]") -> bool:
    """Whether the system's master answers, before the system ends or its time is over."""
    deadline = time.monotonic() + START_PATIENCE
    while time.monotonic() < deadline and system.poll() is None:
        with contextlib.suppress(MasterError):  # on a loaded machine it may open its port long before it answers
            if master.master_answers(master.master_uri()):
                return True
        time.sleep(POLL)
    return False
