"""What a process and all its descendants take together, watched; who takes too much is ended, with the reason.

The kernel limits each process; only a control group limits many at once, and few machines let users make one. psutil
reads the same figures everywhere.
"""

import os
import signal
import threading
from pathlib import Path
from typing import List, Optional

import psutil

MEMORY = 2 * 1024 ** 3  # bytes of all processes together; a node with numpy and OpenCV takes some 200 MB
DISK = 512 * 1024 ** 2  # bytes that a build may write; the lab's takes 2 MB
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
                try:
                    os.killpg(self._pid, signal.SIGKILL)
                except ProcessLookupError:
                    pass
                return


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
    resident = sum(_of(process, False) for process in family)
    return resident if resident <= enough else sum(_of(process, True) for process in family)


def _of(process: "psutil.Process", proportional: bool) -> int:
    try:
        return int(process.memory_full_info().pss if proportional else process.memory_info().rss)
    except psutil.AccessDenied:
        return int(process.memory_info().rss)
    except psutil.NoSuchProcess:
        return 0


def size(folder: Path) -> int:
    """Bytes of disk that a folder's files take; links are not followed."""
    found: List[int] = []
    for place, _, files in os.walk(folder):
        for name in files:
            try:
                found.append(os.lstat(os.path.join(place, name)).st_blocks * 512)
            except FileNotFoundError:
                pass
    return sum(found)
