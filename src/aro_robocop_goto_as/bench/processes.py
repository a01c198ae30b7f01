"""The child processes of a measurement."""

import contextlib
import os
import signal
import tempfile
import time
from pathlib import Path
from typing import Callable, Iterator, List, Mapping, Optional

import rosgraph

from ..errors import BenchError
from ..process import child
from ..process.orphans import end_with_parent
from ..process.ports import free_port

TIMEOUT = 120.0  # [s, wall] for a process to start or to answer, on a busy machine too
END_TIMEOUT = 10.0  # [s, wall] for a process to end by itself
POLL = 0.02  # [s, wall]
CPU_CLOCK = 2  # CPUCLOCK_SCHED, of which clock_getcpuclockid makes a process's clock in Linux


class Child:
    """A named child process that is ended with the block."""

    def __init__(
        self, name: str, command: List[str], log: Path, environment: Optional[Mapping[str, str]] = None
    ) -> None:
        self.name = name
        self.log = log
        self.started = time.monotonic()
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
