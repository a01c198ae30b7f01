"""The child processes of a measurement: master, simulator, client."""

import contextlib
import ctypes
import os
import signal
import sys
import tempfile
import time
from pathlib import Path
from subprocess import PIPE, TimeoutExpired
from typing import Any, Callable, Dict, Iterator, List, Mapping, Optional

import rosgraph

from ..errors import BenchError
from ..process import child
from ..process.ports import free_port
from .drain import Tally

TIMEOUT = 60.0  # [s, wall] for a process to start or to answer, on a busy machine too
END_TIMEOUT = 10.0  # [s, wall] for a process to end by itself
POLL = 0.02  # [s, wall]


class Child:
    """A child process with a name; if `piped`, its input and output are pipes."""

    def __init__(
        self,
        name: str,
        command: List[str],
        log: Path,
        piped: bool = False,
        environment: Optional[Mapping[str, str]] = None,
    ) -> None:
        self.name = name
        self.log = log
        pipes: Dict[str, Any] = {"stdin": PIPE, "stdout": PIPE} if piped else {}
        self.started = time.monotonic()
        self.process = child.start(command, log, environment, text=True, **pipes)

    def require_running(self) -> None:
        """BenchError, with the last line of its log, when it has ended."""
        status = self.process.poll()
        if status is not None:
            words = self.log.read_text(errors="replace").split("\n")
            last = next((line.strip() for line in reversed(words) if line.strip()), "its log is empty")
            raise BenchError(f"{self.name} ended with status {status}: {last}")

    def wait_until(self, condition: Callable[[], bool], what: str) -> None:
        """Wait for a condition that this process brings about; BenchError when it ends or takes too long."""
        deadline = time.monotonic() + TIMEOUT
        while not condition():
            self.require_running()
            if time.monotonic() > deadline:
                raise BenchError(f"{what}: not within {TIMEOUT:g} s")
            time.sleep(POLL)

    def line(self) -> str:
        """The next line of its output; BenchError when it ends instead."""
        assert self.process.stdout is not None
        text = self.process.stdout.readline()
        if not text:
            with contextlib.suppress(TimeoutExpired):
                self.process.wait(END_TIMEOUT)
            self.require_running()
            raise BenchError(f"{self.name} closed its output")
        return str(text)

    def end(self) -> None:
        """Interrupt it; kill it if it does not end."""
        child.end(self.process, signal.SIGINT, END_TIMEOUT)

    def cpu(self) -> float:
        """Processor time [s] of all threads, user and system, to the nanosecond (psutil: to a tick of 10 ms)."""
        clock = ctypes.c_int()
        error = ctypes.CDLL(None).clock_getcpuclockid(self.process.pid, ctypes.byref(clock))
        if error:
            raise BenchError(f"no processor time of {self.name}: {os.strerror(error)}")
        return time.clock_gettime(clock.value)

    def peak_memory(self) -> int:
        """Peak resident memory [bytes], which psutil does not have on Linux."""
        for line in Path(f"/proc/{self.process.pid}/status").read_text().splitlines():
            if line.startswith("VmHWM:"):
                return int(line.split()[1]) * 1024
        raise BenchError(f"no peak memory of {self.name}")


class Client(Child):
    """The drain process."""

    def __init__(self, log: Path, *arguments: str) -> None:
        super().__init__("the client", [sys.executable, "-m", "aro_robocop_goto_as.bench.drain", *arguments], log, True)

    def tally(self) -> Tally:
        """The messages received so far."""
        assert self.process.stdin is not None
        self.process.stdin.write("\n")
        self.process.stdin.flush()
        return Tally.from_json(self.line())

    def end(self) -> None:
        """Close its input, upon which it unregisters from the master and ends."""
        assert self.process.stdin is not None
        with contextlib.suppress(BrokenPipeError):
            self.process.stdin.close()
        child.end(self.process, None, END_TIMEOUT)


@contextlib.contextmanager
def running(process: Child) -> Iterator[Any]:
    """End a process when the block ends."""
    try:
        yield process
    finally:
        process.end()


@contextlib.contextmanager
def own_ros() -> Iterator[Path]:
    """A master on a free port of loopback, with a temporary ROS home; yields that directory."""
    with tempfile.TemporaryDirectory(prefix="robocop_bench_") as name:
        port = free_port()
        own: Dict[str, str] = {
            "ROS_MASTER_URI": f"http://localhost:{port}",
            "ROS_HOSTNAME": "localhost",
            "ROS_HOME": name,
            "ROS_LOG_DIR": os.path.join(name, "log"),
        }
        for variable in ("ROS_IP", "ROS_NAMESPACE"):
            os.environ.pop(variable, None)
        os.environ.update(own)
        with running(Child("the master", ["rosmaster", "--core", "-p", str(port)], Path(name, "master"))) as master:
            master.wait_until(rosgraph.is_master_online, "the ROS master's start")
            yield Path(name)
