"""Whether processes have nothing left to do until a message arrives or time passes: all of their threads sleep.

Simulated time must not pass while a node still works on what it has received, subscribes to a topic, or waits for a
processor on a busy machine. A thread that waits for a processor counts as running in /proc, so the load makes the wait
longer but does not change what is seen at its end.
"""

import contextlib
import os
import threading
from typing import Dict, Iterable, List, Tuple

import psutil

BUSY = (b"R", b"D")  # states of a thread in /proc: running or runnable, waiting for a disk
SWITCHES = b"voluntary_ctxt_switches:"
MOST_OPEN = 400  # files; a process may open 1024
LONGEST = 8192  # [byte] of a file


def tree(pids: Iterable[int]) -> List[int]:
    """Processes with all their descendants; those that have ended are left out."""
    found = []
    for pid in pids:
        with contextlib.suppress(psutil.NoSuchProcess):
            found += [pid, *(child.pid for child in psutil.Process(pid).children(recursive=True))]
    return found


Thread = Tuple[int, int]  # process, thread


class Threads:
    """Looks at threads in /proc, whose files stay open: opening them each time would take four times as long."""

    def __init__(self) -> None:
        self._files: Dict[str, int] = {}  # path -> file descriptor
        # How often a thread was scheduled: without CONFIG_SCHEDSTATS in the kernel, only the slower one has it.
        counted = self._content("/proc/thread-self/schedstat").split()[-1:] not in ([], [b"0"])
        self._counter = "schedstat" if counted else "status"

    def at_rest(self, pids: Iterable[int], polling: bool = False) -> bool:
        """Whether no thread of these processes, except the caller's own, has anything to do.

        The threads are looked at one after the other, and one may wake another meanwhile, so there are two passes:
        nothing has run between them if no thread was scheduled. `polling`: some thread looks for something every few
        milliseconds, so it is enough that all of them sleep in both passes.
        """
        pids = list(pids)
        before = self._times_scheduled(pids)
        if self._busy(before):
            return False
        after = self._times_scheduled(pids)
        return not self._busy(after) if polling else after == before

    def close(self) -> None:
        """Close all files; they are opened again when they are needed."""
        while self._files:
            os.close(self._files.popitem()[1])

    def _times_scheduled(self, pids: Iterable[int]) -> Dict[Thread, bytes]:
        """Of each thread, a text that changes whenever it is scheduled."""
        mine, found = threading.get_native_id(), {}
        for pid in pids:
            with contextlib.suppress(OSError):  # it has ended
                for name in os.listdir(f"/proc/{pid}/task"):
                    if int(name) != mine:
                        content = self._content(f"/proc/{pid}/task/{name}/{self._counter}")
                        found[pid, int(name)] = content[max(0, content.find(SWITCHES)) :]
        return found

    def _busy(self, threads: Iterable[Thread]) -> bool:
        for pid, thread in threads:
            content = self._content(f"/proc/{pid}/task/{thread}/stat")
            if content[content.rfind(b")") + 2 :][:1] in BUSY:
                return True
        return False

    def _content(self, path: str) -> bytes:
        """What a file contains now; nothing if its thread has ended."""
        if path not in self._files:
            if len(self._files) >= MOST_OPEN:
                self.close()
            try:
                self._files[path] = os.open(path, os.O_RDONLY)
            except OSError:
                return b""
        try:
            return os.pread(self._files[path], LONGEST, 0)
        except OSError:
            os.close(self._files.pop(path))
            return b""
