"""A ROS system of one's own, on a free port of loopback, started for a while and ended to its last process."""

import contextlib
import os
import subprocess
import time
from typing import Iterator, List

import rosgraph
import rospy

from .. import descendants, interruption
from ..interruption import Deferred
from ..loopback import free_port

PACKAGE = "aro_robocop_goto_as"
START_PATIENCE = 60.0  # [s, wall] for its master to answer, on a slow machine too
END_PATIENCE = 30.0  # [s, wall] for all of it to end; roslaunch kills by itself what has not ended in 17 s
POLL = 0.05  # [s, wall]


def master_answers() -> bool:
    """Whether a ROS master answers where this process looks for one."""
    online = bool(rosgraph.is_master_online())
    interruption.check()  # rosgraph takes any exception for a no
    return online


@contextlib.contextmanager
def own_system(launch_file: str, arguments: List[str], log: str) -> Iterator[bool]:
    """Launch a file of this package on a master of its own; yields whether that master answers. Output goes to `log`.

    Sets ROS_MASTER_URI of this process. Whatever ends the block, a signal included, ends the system.
    """
    port = free_port()
    os.environ["ROS_MASTER_URI"] = f"http://localhost:{port}"
    os.makedirs(os.path.dirname(log), exist_ok=True)
    descendants.adopt()
    system = None
    try:
        with Deferred():
            system = _launch(port, launch_file, arguments, log)
        yield _wait_for_master(system)
    finally:
        interruption.clean_up()  # an impatient second Ctrl-C must not leave half of a system behind
        rospy.signal_shutdown("the system ends")
        if system is not None:
            _end(system)


def _launch(port: int, launch_file: str, arguments: List[str], log: str) -> "subprocess.Popen[bytes]":
    """In a session of its own, so that Ctrl-C in a terminal reaches this process alone."""
    with open(log, "w") as output:
        return subprocess.Popen(["rosrun", PACKAGE, "robocop_launch.py", "-p", str(port), PACKAGE, launch_file,
                                 *arguments], stdout=output, stderr=subprocess.STDOUT, start_new_session=True)


def _end(system: "subprocess.Popen[bytes]") -> None:
    """roslaunch ends its nodes and its master; what it leaves behind all the same is killed."""
    system.terminate()
    with contextlib.suppress(subprocess.TimeoutExpired):
        system.wait(END_PATIENCE)
    descendants.kill()


def _wait_for_master(system: "subprocess.Popen[bytes]") -> bool:
    deadline = time.monotonic() + START_PATIENCE
    while time.monotonic() < deadline and system.poll() is None:
        if master_answers():
            return True
        time.sleep(POLL)
    return False
