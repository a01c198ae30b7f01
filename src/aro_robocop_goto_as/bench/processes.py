"""The processes of a measurement: master, simulator, client; started, asked, watched, ended."""

import contextlib
import ctypes
import os
import signal
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from typing import Any, Callable, Dict, Iterator, List, Optional

import rosgraph

from ..errors import BenchError
from ..loopback import free_port
from .drain import Tally

PATIENCE = 60.0  # [s, wall] for a process to start or to answer; a busy machine is slow, but not that slow
END_PATIENCE = 10.0  # [s, wall] for a process to end by itself
POLL = 0.02  # [s, wall]


class Child:
    """A process in a session of its own, so that Ctrl-C reaches only the bench, which then ends it."""

    def __init__(self, name: str, command: List[str], log: Path, talk: bool = False) -> None:
        self.name = name
        self.log = log
        pipe: Optional[int] = subprocess.PIPE if talk else None
        self.started = time.monotonic()
        with open(log, "wb") as output:
            self.process = subprocess.Popen(command, stdin=pipe or subprocess.DEVNULL, stdout=pipe or output,
                                            stderr=output, start_new_session=True, text=True)

    def check(self) -> None:
        """BenchError when it has ended by itself, with the last it had to say."""
        status = self.process.poll()
        if status is not None:
            words = self.log.read_text(errors="replace").split("\n")
            last = next((line.strip() for line in reversed(words) if line.strip()), "it said nothing")
            raise BenchError(f"{self.name} ended with status {status}: {last}")

    def wait_until(self, condition: Callable[[], bool], what: str) -> None:
        """Wait for something that this process is to bring about; BenchError when it dies or takes too long."""
        deadline = time.monotonic() + PATIENCE
        while not condition():
            self.check()
            if time.monotonic() > deadline:
                raise BenchError(f"{what}: not within {PATIENCE:g} s")
            time.sleep(POLL)

    def line(self) -> str:
        """The next line it writes; BenchError when it ends instead."""
        assert self.process.stdout is not None
        text = self.process.stdout.readline()
        if not text:
            with contextlib.suppress(subprocess.TimeoutExpired):
                self.process.wait(END_PATIENCE)
            self.check()
            raise BenchError(f"{self.name} says no more")
        return str(text)

    def end(self) -> None:
        """Interrupt it; kill it when that does not help."""
        for number in (signal.SIGINT, signal.SIGKILL):
            if self.process.poll() is None:
                self.process.send_signal(number)
                with contextlib.suppress(subprocess.TimeoutExpired):
                    self.process.wait(END_PATIENCE)
        for pipe in (self.process.stdin, self.process.stdout):
            if pipe is not None:
                with contextlib.suppress(BrokenPipeError):
                    pipe.close()

    def cpu(self) -> float:
        """Processor time [s] it has used, user and system, all threads, to the nanosecond."""
        clock = ctypes.c_int()
        error = ctypes.CDLL(None).clock_getcpuclockid(self.process.pid, ctypes.byref(clock))
        if error:
            raise BenchError(f"no processor time of {self.name}: {os.strerror(error)}")
        return time.clock_gettime(clock.value)

    def peak_memory(self) -> int:
        """The most memory [bytes] it ever had resident."""
        for line in Path(f"/proc/{self.process.pid}/status").read_text().splitlines():
            if line.startswith("VmHWM:"):
                return int(line.split()[1]) * 1024
        raise BenchError(f"no peak memory of {self.name}")


class Client(Child):
    """The drain process."""

    def __init__(self, log: Path, *arguments: str) -> None:
        super().__init__("the client", [sys.executable, "-m", "aro_robocop_goto_as.bench.drain", *arguments], log, True)

    def tally(self) -> Tally:
        """What has arrived until now."""
        assert self.process.stdin is not None
        self.process.stdin.write("\n")
        self.process.stdin.flush()
        return Tally.from_json(self.line())

    def end(self) -> None:
        """The end of its input ends it; only then it takes leave of the master."""
        if self.process.stdin is not None:
            with contextlib.suppress(BrokenPipeError):
                self.process.stdin.close()
            with contextlib.suppress(subprocess.TimeoutExpired):
                self.process.wait(END_PATIENCE)
        super().end()


@contextlib.contextmanager
def running(child: Child) -> Iterator[Any]:
    """Have a process end with the block."""
    try:
        yield child
    finally:
        child.end()


@contextlib.contextmanager
def own_ros() -> Iterator[Path]:
    """A master on a free port of loopback, a ROS home of its own; yields the directory of both, gone at the end."""
    with tempfile.TemporaryDirectory(prefix="robocop_bench_") as name:
        port = free_port()
        own: Dict[str, str] = {"ROS_MASTER_URI": f"http://localhost:{port}", "ROS_HOSTNAME": "localhost",
                               "ROS_HOME": name, "ROS_LOG_DIR": os.path.join(name, "log")}
        for variable in ("ROS_IP", "ROS_NAMESPACE"):
            os.environ.pop(variable, None)
        os.environ.update(own)
        with running(Child("the master", ["rosmaster", "--core", "-p", str(port)], Path(name, "master"))) as master:
            master.wait_until(rosgraph.is_master_online, "the ROS master's start")
            yield Path(name)
