"""For how long processes do nothing, which no load of the machine can make them look like.

They do something while a thread runs, waits for the processor, or waits for a disk. The kernel counts the first two in
/proc/PID/task/TID/schedstat; where it has no such file, no process is idle.
"""

import contextlib
import glob
import time
from pathlib import Path
from typing import Dict

import psutil

LOOK = 1.0  # [s, wall] from one look to the next


class Stillness:
    """Looks at a process and its descendants every LOOK seconds."""

    def __init__(self, pid: int) -> None:
        self.idle = 0.0  # [s, wall] in which none of them did anything
        self._pid, self._looked = pid, time.monotonic()
        self._work: Dict[str, float] = {}  # by thread, for how long [s] it has run or waited for the processor

    def look(self) -> float:
        """Look, unless the last look was a moment ago; `idle`."""
        length = time.monotonic() - self._looked
        if length >= LOOK:
            self._looked, before = self._looked + length, self._work
            is_busy = self._look_at_threads()
            done = sum(max(0.0, seconds - before.get(thread, 0.0)) for thread, seconds in self._work.items())
            self.idle += 0.0 if is_busy else max(0.0, length - done)
        return self.idle

    def _look_at_threads(self) -> bool:
        """Note for how long each thread has worked [s]; return whether one of them works now."""
        self._work, is_busy = {}, False
        with contextlib.suppress(psutil.Error):
            top = psutil.Process(self._pid)
            for process in (top, *top.children(recursive=True)):
                for folder in map(Path, glob.glob(f"/proc/{process.pid}/task/*")):  # none of a process that has ended
                    try:
                        state = (folder / "stat").read_text().rpartition(")")[2].split()[0]
                        ran, waited = map(int, (folder / "schedstat").read_text().split()[:2])
                    except OSError:
                        is_busy |= folder.exists()  # else it has ended
                        continue
                    is_busy |= state in "RD"
                    self._work[str(folder)] = (ran + waited) / 1e9
        return is_busy
