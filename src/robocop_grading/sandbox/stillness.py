"""Whether processes do nothing at all, which no load of the machine can make them look like.

A thread that waits for the processor is shown as running (R), and one that waits for a disk as D. So a process is still
only if it waits for something that does not come, however slow the machine is.
"""

import contextlib
import glob
import time
from pathlib import Path
from typing import Dict, Optional

import psutil

LOOK = 1.0  # [s, wall] from one look to the next; a thread of the agent's wakes up every 0.005 s


class Stillness:
    """Looks at a process and its descendants every LOOK seconds."""

    def __init__(self, pid: int) -> None:
        self.looks = 0  # in a row at which no thread had run since the look before, or wanted to
        self.switches = 0  # how often their threads have begun to run since the first look
        self._pid, self._next = pid, time.monotonic() + LOOK
        self._seen: Optional[Dict[str, int]] = None  # thread -> how often it has run

    def look(self) -> int:
        """Look, unless the last look was a moment ago; `looks`."""
        if time.monotonic() >= self._next:
            self._next = time.monotonic() + LOOK
            seen = self._threads()
            self.looks = self.looks + 1 if seen is not None and seen == self._seen else 0
            if seen is not None:
                before = seen if self._seen is None else self._seen
                self.switches += sum(max(0, count - before.get(thread, 0)) for thread, count in seen.items())
                self._seen = seen
        return self.looks

    def _threads(self) -> Optional[Dict[str, int]]:
        """How often each thread has run; None if one of them runs, or waits for the processor or a disk."""
        found: Dict[str, int] = {}
        with contextlib.suppress(psutil.Error):
            top = psutil.Process(self._pid)
            for process in (top, *top.children(recursive=True)):
                for path in glob.glob(f"/proc/{process.pid}/task/*/status"):  # none of a process that has ended
                    with contextlib.suppress(OSError):  # it has ended
                        fields = dict(line.split(":", 1) for line in Path(path).read_text().splitlines() if ":" in line)
                        if fields["State"].split()[0] in "RD":
                            return None
                        kinds = ("voluntary_ctxt_switches", "nonvoluntary_ctxt_switches")
                        found[path] = sum(int(fields[kind]) for kind in kinds)
        return found
