"""Whether processes do nothing at all, which no load of the machine can make them look like.

A thread that waits for the processor is shown as running (R), and one that waits for a disk as D. So a process is still
only if it waits for something that does not come, however slow the machine is.
"""

import contextlib
import glob
import time
from pathlib import Path
from typing import Dict, Optional, Set, Tuple

import psutil

LOOK = 1.0  # [s, wall] from one look to the next; a thread of the agent's wakes up every 0.005 s


class Stillness:
    """Looks at a process and its descendants every LOOK seconds."""

    def __init__(self, pid: int, spare: int = 0) -> None:
        """`spare`: how many threads may run now and then, but not at two looks in a row."""
        self.looks = 0  # in a row at which no thread had run since the look before, or wanted to
        self.switches = 0  # how often their threads have begun to run since the first look
        self._pid, self._spare, self._next = pid, spare, time.monotonic() + LOOK
        self._wanted = False  # one wanted to run at the look before
        self._seen: Optional[Dict[str, int]] = None  # thread -> how often it has run

    def look(self) -> int:
        """Look, unless the last look was a moment ago; `looks`."""
        if time.monotonic() >= self._next:
            self._next = time.monotonic() + LOOK
            seen, wanting = self._threads()
            before = self._seen
            if before is None:
                before = self._seen = seen
                wanting = set(seen)
            ran = wanting | {thread for thread in {*seen, *before} if seen.get(thread) != before.get(thread)}
            if len(ran) > self._spare or (wanting and self._wanted):
                self.looks = 0
            elif not wanting:  # one that runs now and then is seldom seen to, one that starves always
                self.looks += 1
            self._wanted = bool(wanting)
            self.switches += sum(max(0, count - before.get(thread, 0)) for thread, count in seen.items())
            self._seen = seen
        return self.looks

    def _threads(self) -> Tuple[Dict[str, int], Set[str]]:
        """How often each thread has run, and those that run, or wait for the processor or a disk."""
        found: Dict[str, int] = {}
        wanting: Set[str] = set()
        with contextlib.suppress(psutil.Error):
            top = psutil.Process(self._pid)
            for process in (top, *top.children(recursive=True)):
                for path in glob.glob(f"/proc/{process.pid}/task/*/status"):  # none of a process that has ended
                    with contextlib.suppress(OSError):  # it has ended
                        fields = dict(line.split(":", 1) for line in Path(path).read_text().splitlines() if ":" in line)
                        if fields["State"].split()[0] in "RD":
                            wanting.add(path)
                        kinds = ("voluntary_ctxt_switches", "nonvoluntary_ctxt_switches")
                        found[path] = sum(int(fields[kind]) for kind in kinds)
        return found, wanting
