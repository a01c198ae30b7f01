"""What the scheduler does not see: threads that wait in another way, and other processes of the hand-in.

Both are found in /proc. A thread that the kernel shows asleep, not for a disk, and that has not run between two looks,
counts as waiting. Other processes hold simulated time as long as they work, and count with their processor time.
"""

import contextlib
import glob
import os
import re
import sys
import time
from typing import Dict, Iterator, List, Optional, Set

from . import scheduler
from .threads import native_ids

STARTS = ("subprocess.Popen", "os.fork", "os.forkpty", "os.posix_spawn", "os.system")  # audit events
TICK = os.sysconf("SC_CLK_TCK")
ASLEEP = re.compile(r"^State:\s*[ST].*^voluntary_ctxt_switches:\s*(\d+)", re.MULTILINE | re.DOTALL)  # in a status file
_process_time, _thread_time = time.process_time, time.thread_time
_asleep: Dict[int, str] = {}  # threads at the previous look, with how often they have run


def all_asleep() -> Optional[Set[int]]:
    """The threads that run, if each was asleep at this look and the previous one, and did not run; else None."""
    global _asleep
    with scheduler.guard:
        threads = set(scheduler.running)
        if scheduler.starting or threads & scheduler.calling.keys():
            return None
    found = {thread: _sleep_of(native_ids.get(thread, 0)) for thread in threads}
    same = all(switches and _asleep.get(thread) == switches for thread, switches in found.items())
    _asleep = found
    return threads if same else None


def _sleep_of(native_id: int) -> str:
    """How often a thread has run, if it sleeps now."""
    try:
        with open(f"/proc/self/task/{native_id}/status") as file:
            asleep = ASLEEP.search(file.read())
    except OSError:  # it has ended
        return "ended"
    return asleep.group(1) if asleep else ""


class Others:
    """The other processes that the hand-in has started, and what they do."""

    def __init__(self) -> None:
        self.exist = False  # whether it has ever started one
        self.work = False  # whether one of them works, or waits for the processor, at the last look
        self.processor_time = 0.0  # [s] of those that live
        sys.addaudithook(self._notice)

    def _notice(self, event: str, _arguments: object) -> None:
        if event in STARTS:
            self.exist = True

    def look(self) -> None:
        """Look at them, if there are any."""
        if not self.exist:
            return
        waiting, states, ticks = _children(os.getpid()), "", 0
        while waiting:
            process = waiting.pop()
            waiting += _children(process)
            for words in _words_of(f"/proc/{process}/task/*/stat"):
                states += words[0]
                ticks += int(words[11]) + int(words[12])
        self.work = "R" in states or "D" in states
        self.processor_time = ticks / TICK


def _children(process: int) -> List[int]:
    """Process ids; none where the kernel does not list them."""
    return [int(word) for words in _words_of(f"/proc/{process}/task/*/children") for word in words]


def _words_of(pattern: str) -> Iterator[List[str]]:
    """The words of each of these files, from behind a name in brackets."""
    for path in glob.glob(pattern):
        with contextlib.suppress(OSError):  # it has ended
            with open(path) as file:
                yield file.read().rpartition(")")[2].split()


def processor_time() -> float:
    """[s] that this process has used, without the thread that asks, and the others, as of the last look at them."""
    return _process_time() - _thread_time() + others.processor_time


others = Others()
