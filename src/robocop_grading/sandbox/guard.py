"""Watches a process tree: kills the tree when it exceeds a limit.

The kernel's limits are per process; these limits are for all processes together. The kernel's memory for sockets,
pipes and entries of folders belongs to no process, so it is not counted.
"""

import contextlib
import math
import threading
from pathlib import Path
from typing import Callable, List, Sequence

import psutil

from robocop_hosting.child import kill_tree

from ..agent.processes import descendants_of
from .limits import MAX_MEMORY, MAX_PROCESSES

PERIOD = 0.1  # [s, wall]
COUNTERS = Path("/proc/vmstat")


class Guard:
    """Watches a process and its descendants until `stop`."""

    def __init__(
        self,
        pid: int,
        memory: int = MAX_MEMORY,
        processor_time: float = math.inf,
        processes: float = MAX_PROCESSES,
        used: float = 0.0,
    ) -> None:
        """Limits of all processes together: `memory` [bytes], `processor_time` [s], `processes`.

        `used`: processor time [s] of earlier processes, which counts, too.
        """
        self.reason = ""  # why they were killed, if they were
        self.used = used
        self._processor_time, self._most = processor_time, processes
        self._pid, self._memory = pid, memory
        self._stopped = threading.Event()
        self._thread = threading.Thread(target=self._watch, daemon=True)
        self._thread.start()

    def stop(self) -> None:
        """Stop watching; from now on `reason` does not change."""
        self._stopped.set()
        self._thread.join()

    def _watch(self) -> None:
        earlier = self.used
        while not self._stopped.wait(PERIOD):
            processes = _processes(self._pid)
            self.used = max(self.used, earlier + _sum(processes, _processor_time))
            if all(_sum(processes, memory) > self._memory for memory in (_resident, _proportional)):
                self.reason = f"its processes together took more than {self._memory / 1024**2:g} MB of memory"
            elif len(processes) > self._most:
                self.reason = f"it started more than {self._most} processes"
            elif self.used > self._processor_time:
                self.reason = f"its processes together used more than {self._processor_time:g} s of processor time"
            if self.reason:
                kill_tree(self._pid)
                return


def kernel_kills() -> int:
    """How many processes the kernel has killed since its start because memory ran out; 0 if it does not tell."""
    try:
        return int(dict(line.split() for line in COUNTERS.read_text().splitlines())["oom_kill"])
    except (OSError, ValueError, KeyError):
        return 0


def _processes(pid: int) -> List["psutil.Process"]:
    """A process and its descendants that have not ended."""
    found = []
    for each in (pid, *descendants_of(pid)):
        with contextlib.suppress(psutil.NoSuchProcess):
            found.append(psutil.Process(each))
    return found


def _sum(processes: Sequence["psutil.Process"], of: Callable[["psutil.Process"], float]) -> float:
    """What `of` says of all processes together."""
    total = 0.0
    for process in processes:
        with contextlib.suppress(psutil.Error):  # it has ended
            total += of(process)
    return total


def _processor_time(process: "psutil.Process") -> float:
    """Processor time [s] of a process and of its children that have ended."""
    return float(sum(process.cpu_times()[:4]))


def _resident(process: "psutil.Process") -> float:
    """Bytes of memory that a process uses; a page that n processes use counts fully for each of them."""
    return float(process.memory_info().rss)


def _proportional(process: "psutil.Process") -> float:
    """Bytes of memory; a page that n processes use counts one n-th for each. The kernel takes long to find this."""
    try:
        return float(process.memory_full_info().pss)
    except psutil.AccessDenied:
        return _resident(process)
