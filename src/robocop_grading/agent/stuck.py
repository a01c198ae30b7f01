"""Finds what the scheduler does not see: threads that wait in an unknown way, and other processes of the hand-in.

Both are found in /proc. A thread counts as waiting if the kernel shows it asleep, but not for a disk, and it has not
run between two looks. Other processes hold simulated time as long as they work, and their processor time counts as the
node's.
"""

import os
import re
import sys
import time
from typing import Dict, Optional, Set

from .processes import descendants_of, words_of
from .scheduler import scheduler
from .threads import native_ids

FORKS = ("os.fork", "os.forkpty")  # audit events
STARTS = (*FORKS, "subprocess.Popen", "os.posix_spawn", "os.system")
FORKED = "other Python processes"
ROS_PROGRAM = re.compile(r"\b(?:ros(?:bag|launch|node|param|run|service|topic)|roscore)\b")
TICKS_PER_SECOND = os.sysconf("SC_CLK_TCK")
ASLEEP = re.compile(r"^State:\s*[ST].*^voluntary_ctxt_switches:\s*(\d+)", re.MULTILINE | re.DOTALL)  # in a status file
_process_time, _thread_time = time.process_time, time.thread_time
_asleep: Dict[int, str] = {}  # the threads at the previous look, and how often each of them has run


def all_asleep() -> Optional[Set[int]]:
    """The running threads, if all of them count as waiting; otherwise None."""
    global _asleep
    with scheduler.guard:
        threads = set(scheduler.running)
        if scheduler.starting or threads & scheduler.calling:
            return None
    found = {thread: _sleep_of(native_ids.get(thread, 0)) for thread in threads}
    before, _asleep = _asleep, found
    return threads if all(switches and before.get(it) == switches for it, switches in found.items()) else None


def _sleep_of(native_id: int) -> str:
    """How often a thread has run, if it sleeps now; "ended" if it is gone, otherwise an empty text."""
    try:
        with open(f"/proc/self/task/{native_id}/status", errors="replace") as file:  # a thread has any name
            asleep = ASLEEP.search(file.read())
    except OSError:  # it has ended
        return "ended"
    return asleep.group(1) if asleep else ""


class ChildProcesses:
    """The processes that the hand-in has started, and what they do."""

    def __init__(self) -> None:
        self.were_started = False  # whether the hand-in has ever started a process
        self.busy = False  # whether a process ran, or waited for the processor or a disk, at the last poll
        self.processor_time = 0.0  # [s] of the processes that lived at the last poll
        self.programs: Set[str] = set()  # of ROS, and forked processes, that were started; they find no master
        sys.addaudithook(self._notice)

    def _notice(self, event: str, arguments: object) -> None:
        if event in STARTS:
            self.were_started = True
            self.programs.update([FORKED] if event in FORKS else ROS_PROGRAM.findall(repr(arguments)))

    def poll(self) -> None:
        """Update `busy` and `processor_time`, if the hand-in has ever started a process."""
        if not self.were_started:
            return
        states, ticks = "", 0
        for process in descendants_of(os.getpid()):
            for words in words_of(f"/proc/{process}/task/*/stat"):
                states += words[0]
                ticks += int(words[11]) + int(words[12])
        self.busy = "R" in states or "D" in states
        self.processor_time = ticks / TICKS_PER_SECOND


def processor_time() -> float:
    """Processor time [s] of this process without the calling thread, and of its children at their last poll."""
    return _process_time() - _thread_time() + children.processor_time


children = ChildProcesses()
