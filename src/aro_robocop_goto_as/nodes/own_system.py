"""A ROS system of one's own, on a free port of loopback, started for a while and ended to its last process."""

import contextlib
import os
import signal
import subprocess
import time
import uuid
from pathlib import Path
from typing import Iterator, List

import rosgraph
import rospy

from ..loopback import free_port

PACKAGE = "aro_robocop_goto_as"
MARK = "ROBOCOP_SYSTEM"  # environment variable that tells such a system's processes from all others
START_PATIENCE = 60.0  # [s, wall] for its master to answer, on a slow machine too
END_PATIENCE = 30.0  # [s, wall] for all of it to end; roslaunch kills by itself what has not ended in 17 s
POLL = 0.05  # [s, wall]
ENDING_SIGNALS = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)


@contextlib.contextmanager
def own_system(launch_file: str, arguments: List[str], log: str) -> Iterator[bool]:
    """Launch a file of this package on a master of its own; yields whether that master answers. Output goes to `log`.

    Sets ROS_MASTER_URI of this process. Whatever ends the block, a signal included, ends the system.
    """
    port, mark = free_port(), f"{MARK}={uuid.uuid4().hex}"
    os.environ["ROS_MASTER_URI"] = f"http://localhost:{port}"
    os.makedirs(os.path.dirname(log), exist_ok=True)
    name, _, value = mark.partition("=")
    with open(log, "w") as output:
        system = subprocess.Popen(["roslaunch", "-p", str(port), PACKAGE, launch_file, *arguments], stdout=output,
                                  stderr=subprocess.STDOUT, start_new_session=True, env={**os.environ, name: value})
    try:
        yield _wait_for_master(system)
    finally:
        with _ctrl_c_ignored():
            rospy.signal_shutdown("the system ends")
            _end(system, mark.encode())


@contextlib.contextmanager
def _ctrl_c_ignored() -> Iterator[None]:
    """An impatient second Ctrl-C must not leave half of a system behind."""
    before = {number: signal.signal(number, signal.SIG_IGN) for number in ENDING_SIGNALS}
    try:
        yield
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)


def _end(system: "subprocess.Popen[bytes]", mark: bytes) -> None:
    """roslaunch ends its nodes and its master; what it has lost sight of, as when it was still starting, is killed."""
    system.terminate()
    try:
        system.wait(END_PATIENCE)
    except subprocess.TimeoutExpired:
        system.kill()
        system.wait()
    for process in _processes_with(mark):
        with contextlib.suppress(ProcessLookupError):
            os.kill(process, signal.SIGKILL)


def _processes_with(setting: bytes) -> List[int]:
    """Ids of processes with `setting`, NAME=value, in their environment: roslaunch gives nodes their own session."""
    found = []
    for environment in Path("/proc").glob("[0-9]*/environ"):
        with contextlib.suppress(OSError):  # ended meanwhile, or somebody else's
            if setting in environment.read_bytes().split(b"\0"):
                found.append(int(environment.parent.name))
    return found


def _wait_for_master(system: "subprocess.Popen[bytes]") -> bool:
    deadline = time.monotonic() + START_PATIENCE
    while time.monotonic() < deadline and system.poll() is None:
        if rosgraph.is_master_online():
            return True
        time.sleep(POLL)
    return False
