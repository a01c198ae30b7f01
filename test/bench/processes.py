"""The child processes of a measurement, and the checkouts whose programs they run."""

import contextlib
import os
import signal
import subprocess
import tempfile
import time
from dataclasses import dataclass
from pathlib import Path
from typing import Callable, Dict, Iterator, List, Mapping, Optional

import rosgraph

from aro_robocop_goto_as.process import child
from aro_robocop_goto_as.process.orphans import end_with_parent
from aro_robocop_goto_as.process.ports import free_port

from . import BenchError

TIMEOUT = 120.0  # [s, wall] for a process to start or to answer
SETUP_TIMEOUT = 1800.0  # [s, wall] for `./robocop shell` of the other checkout, which may have to build it first
END_TIMEOUT = 10.0  # [s, wall] for a process to end by itself
POLL = 0.02  # [s, wall]
CPU_CLOCK = 2  # CPUCLOCK_SCHED, of which clock_getcpuclockid makes a process's clock in Linux


class Child:
    """A named child process that is ended with the block."""

    def __init__(
        self, name: str, command: List[str], log: Path, environment: Optional[Mapping[str, str]] = None
    ) -> None:
        self.name, self.log, self.started = name, log, time.monotonic()
        self.process = child.start(command, log, environment, preexec_fn=end_with_parent())  # from the main thread

    def __enter__(self) -> "Child":
        return self

    def __exit__(self, *_error: object) -> None:
        child.end(self.process, signal.SIGINT, END_TIMEOUT)

    def _lines(self) -> List[str]:
        return [line.strip() for line in self.log.read_text(errors="replace").split("\n") if line.strip()]

    def says(self, word: str) -> bool:
        """Whether the process has printed this word on a line of its own; BenchError when it has ended."""
        self.require_running()
        return word in self._lines()

    def require_running(self) -> None:
        """BenchError, with the last line of its log, when it has ended."""
        status = self.process.poll()
        if status is not None:
            raise BenchError(f"{self.name} ended with status {status}: {(self._lines() or ['its log is empty'])[-1]}")

    def wait_until(self, condition: Callable[[], bool], what: str) -> None:
        """Wait for a condition that this process brings about; BenchError when it ends or takes too long."""
        deadline = time.monotonic() + TIMEOUT
        while not condition():
            self.require_running()
            if time.monotonic() > deadline:
                raise BenchError(f"{what}: timed out after {TIMEOUT:g} s")
            time.sleep(POLL)

    def cpu(self) -> float:
        """Processor time [s] of all threads, user and system, to the nanosecond (psutil: to a tick of 10 ms)."""
        return time.clock_gettime(~self.process.pid << 3 | CPU_CLOCK)

    def peak_memory(self) -> int:
        """Peak resident memory [bytes], which psutil does not have on Linux."""
        status = Path(f"/proc/{self.process.pid}/status").read_text().split()
        return int(status[status.index("VmHWM:") + 1]) * 1024


@contextlib.contextmanager
def own_ros() -> Iterator[Path]:
    """A master on a free port of loopback, with a temporary ROS home; yields that directory."""
    with tempfile.TemporaryDirectory(prefix="robocop_bench_") as name:
        port = free_port()
        for variable in ("ROS_IP", "ROS_NAMESPACE"):
            os.environ.pop(variable, None)
        os.environ.update(
            ROS_MASTER_URI=f"http://localhost:{port}",
            ROS_HOSTNAME="localhost",
            ROS_HOME=name,
            ROS_LOG_DIR=os.path.join(name, "log"),
        )
        with Child("the master", ["rosmaster", "--core", "-p", str(port)], Path(name, "master")) as master:
            master.wait_until(rosgraph.is_master_online, "the ROS master's start")
            yield Path(name)


@dataclass(frozen=True)
class Checkout:
    """A checkout's name in the report, and the environment of its workspace."""

    name: str
    variables: Mapping[str, str]

    @property
    def programs(self) -> Path:
        """The folder of its nodes."""
        return Path(self.variables["ROBOCOP_WS"], "lib", "aro_robocop_goto_as")

    def environment(self) -> Dict[str, str]:
        """Its workspace with the ROS master of this measurement."""
        ros = {name: value for name, value in os.environ.items() if name.startswith("ROS_") and "PACKAGE" not in name}
        workspace = {name: value for name, value in self.variables.items() if name not in ("ROS_IP", "ROS_NAMESPACE")}
        return {**workspace, **ros}


def this_checkout() -> Checkout:
    """The checkout of this program."""
    return Checkout("this", dict(os.environ))


def other_checkout(root: Path) -> Checkout:
    """A checkout as its own `./robocop shell` sets it up; BenchError when it can't be."""
    command = [str(root.absolute() / "robocop"), "shell", "env", "-0"]
    own = os.environ["ROBOCOP_STATE"] + os.sep  # what this checkout's workspace has added to paths is left out
    clean = {}
    for name, value in os.environ.items():
        parts = [part for part in value.split(":") if not part.startswith(own)]
        if parts and not name.startswith("ROBOCOP_"):
            clean[name] = ":".join(parts)
    try:
        pipe = subprocess.PIPE
        done = subprocess.run(
            command, env=clean, stdin=subprocess.DEVNULL, stdout=pipe, text=True, timeout=SETUP_TIMEOUT, check=True
        )
    except (OSError, subprocess.SubprocessError) as error:
        raise BenchError(f"--against {root}: expected a checkout of this project: {error}") from error
    variables = dict(entry.split("=", 1) for entry in done.stdout.split("\0") if "=" in entry)
    if "ROBOCOP_WS" not in variables:
        raise BenchError(f"--against {root}: its ./robocop shell does not set ROBOCOP_WS")
    return Checkout("other", variables)
