"""What a process and all its descendants take together, watched; who takes too much is ended, with the reason.

The kernel limits each process; only a control group limits many at once, and few machines let users make one. psutil
reads the same figures everywhere.
"""

import os
import signal
import threading
from pathlib import Path
from typing import Dict, List, Optional, Sequence

import psutil

MEMORY = 2 * 1024 ** 3  # bytes of all processes together; a node with numpy and OpenCV takes some 200 MB
DISK = 512 * 1024 ** 2  # bytes that a build may write; the lab's takes 2 MB
SMALLEST = 4096  # bytes that a file counts at least
PERIOD = 0.1  # [s, wall]


class Guard:
    """Watches over a process that leads a process group, until `stop`; `reason` says why it was ended, if it was."""

    def __init__(self, pid: int, folder: Optional[Path] = None, memory: int = MEMORY, disk: int = DISK) -> None:
        self.reason = ""
        self._pid, self._folder, self._memory, self._disk = pid, folder, memory, disk
        self._stopped = threading.Event()
        self._thread = threading.Thread(target=self._watch, daemon=True)
        self._thread.start()

    def stop(self) -> None:
        """No more watching; `reason` is final."""
        self._stopped.set()
        self._thread.join()

    def _watch(self) -> None:
        while not self._stopped.wait(PERIOD):
            if together(self._pid, self._memory) > self._memory:
                self.reason = f"its processes together took more than {self._memory / 1024 ** 2:g} MB of memory"
            elif self._folder is not None and size(self._folder) > self._disk:
                self.reason = f"it wrote more than {self._disk / 1024 ** 2:g} MB"
            if self.reason:
                kill_group(self._pid)
                return


def kill_group(leader: int) -> None:
    """End a process group at once, if there still is one."""
    try:
        os.killpg(leader, signal.SIGKILL)
    except ProcessLookupError:
        pass


def together(pid: int, enough: int) -> int:
    """Bytes of memory of a process and its descendants.

    Resident sizes count shared pages once for each process, which is quick and enough below `enough`; beyond it,
    proportional sizes count them once for all.
    """
    try:
        top = psutil.Process(pid)
        family = [top, *top.children(recursive=True)]
    except psutil.NoSuchProcess:
        return 0
    unmapped = _unmapped(family)
    resident = sum(_of(process, False) for process in family) + unmapped
    return resident if resident <= enough else sum(_of(process, True) for process in family) + unmapped


def _of(process: "psutil.Process", proportional: bool) -> int:
    try:
        return int(process.memory_full_info().pss if proportional else process.memory_info().rss)
    except psutil.AccessDenied:
        return int(process.memory_info().rss)
    except psutil.NoSuchProcess:
        return 0


def _unmapped(family: Sequence["psutil.Process"]) -> int:
    """Bytes of files that are memory only (memfd), which belong to no process's size unless it has them mapped."""
    found: Dict[int, int] = {}
    for process in family:
        folder = f"/proc/{process.pid}/fd"
        try:
            for entry in os.scandir(folder):
                if os.readlink(entry.path).startswith("/memfd:"):
                    status = os.stat(entry.path)
                    found[status.st_ino] = status.st_blocks * 512
        except OSError:  # it has ended, or is not ours to look into
            pass
    return sum(found.values())


def size(folder: Path) -> int:
    """Bytes of disk that a folder's files take, an empty one a little too; links are not followed."""
    found: List[int] = []
    for place, _, files in os.walk(folder):
        for name in files:
            try:
                found.append(max(SMALLEST, os.lstat(os.path.join(place, name)).st_blocks * 512))
            except FileNotFoundError:
                pass
    return sum(found)
