"""Finds what the scheduler does not see: threads that wait in an unknown way, and other processes of the hand-in.

Both are found in /proc. A thread counts as waiting if the kernel shows it asleep, but not for a disk, and it has not
run between two looks. A thread that polls in C also counts as waiting if it has slept for most of a second in which no
other thread had a turn; it does so until it waits in a known way. Other processes hold simulated time as
long as they work, and their processor time counts as the node's.
"""

import contextlib
import glob
import math
import os
import re
import sys
import time
from typing import Dict, Iterator, List, Optional, Set

from .scheduler import scheduler
from .threads import native_ids

STARTS = ("subprocess.Popen", "os.fork", "os.forkpty", "os.posix_spawn", "os.system")  # audit events
ROS_PROGRAM = re.compile(r"\b(?:ros(?:bag|launch|node|param|run|service|topic)|roscore)\b")
TICKS_PER_SECOND = os.sysconf("SC_CLK_TCK")
ASLEEP = re.compile(r"^State:\s*[ST].*^voluntary_ctxt_switches:\s*(\d+)", re.MULTILINE | re.DOTALL)  # in a status file
WINDOW = 1.0  # [s, wall]
_process_time, _thread_time, _wall_time = time.process_time, time.thread_time, time.monotonic
_asleep: Dict[int, str] = {}  # the threads at the previous look, and how often each of them has run
_pollers: Set[int] = set()  # threads that have slept for most of a window
_window: Optional["_Window"] = None


def all_asleep() -> Optional[Set[int]]:
    """The running threads, if all of them count as waiting; otherwise None."""
    global _asleep, _window
    with scheduler.guard:
        threads = set(scheduler.running)
        if scheduler.starting or threads & scheduler.calling:
            return None
    found = {thread: _sleep_of(native_ids.get(thread, 0)) for thread in threads}
    same = {thread for thread, switches in found.items() if switches and _asleep.get(thread) == switches}
    _asleep = found
    _pollers.intersection_update(scheduler.background)  # the other pollers have waited in a known way since
    if _window is None or not _window.look(found):
        _window = _Window(threads)
    _pollers.update(_window.pollers())
    return threads if threads <= same | _pollers else None


def _sleep_of(native_id: int) -> str:
    """How often a thread has run, if it sleeps now; "ended" if it is gone, otherwise an empty text."""
    try:
        with open(f"/proc/self/task/{native_id}/status", errors="replace") as file:  # a thread has any name
            asleep = ASLEEP.search(file.read())
    except OSError:  # it has ended
        return "ended"
    return asleep.group(1) if asleep else ""


class _Window:
    """A period in which the same threads run; it finds the threads that sleep for most of the period."""

    def __init__(self, threads: Set[int]) -> None:
        self.turn, self.since = scheduler.turns, _wall_time()
        self._work = {thread: _work_of(native_ids.get(thread, 0)) for thread in threads}
        self._awake = dict.fromkeys(threads, 0)  # at how many looks; a thread that waits for a disk is awake
        self._looks = 0

    def look(self, found: Dict[int, str]) -> bool:
        """Note what a look has found; return whether it belongs to this window."""
        if self.turn != scheduler.turns or self._awake.keys() != found.keys():
            return False
        self._looks += 1
        for thread, asleep in found.items():
            self._awake[thread] += not asleep
        return True

    def pollers(self) -> Set[int]:
        """The threads that sleep for most of the window, once it is over."""
        length = _wall_time() - self.since
        if length < WINDOW:
            return set()
        seldom = {thread for thread, awake in self._awake.items() if awake < self._looks / 2}
        return {it for it in seldom if _work_of(native_ids.get(it, 0)) - self._work[it] < length / 2.0}


def _work_of(native_id: int) -> float:
    """For how long [s] a thread has run or waited for the processor; NaN if the kernel does not tell."""
    try:
        with open(f"/proc/self/task/{native_id}/schedstat") as file:
            return sum(map(int, file.read().split()[:2])) / 1e9
    except (OSError, ValueError):
        return math.nan


class ChildProcesses:
    """The processes that the hand-in has started, and what they do."""

    def __init__(self) -> None:
        self.were_started = False  # whether the hand-in has ever started a process
        self.busy = False  # whether a process ran, or waited for the processor or a disk, at the last poll
        self.processor_time = 0.0  # [s] of the processes that lived at the last poll
        self.ros_programs: Set[str] = set()  # programs of ROS that were started; they find no master
        sys.addaudithook(self._notice)

    def _notice(self, event: str, arguments: object) -> None:
        if event in STARTS:
            self.were_started = True
            self.ros_programs.update(ROS_PROGRAM.findall(repr(arguments)))

    def poll(self) -> None:
        """Update `busy` and `processor_time`, if the hand-in has ever started a process."""
        if not self.were_started:
            return
        waiting, states, ticks = _children(os.getpid()), "", 0
        while waiting:
            process = waiting.pop()
            waiting += _children(process)
            for words in _words_of(f"/proc/{process}/task/*/stat"):
                states += words[0]
                ticks += int(words[11]) + int(words[12])
        self.busy = "R" in states or "D" in states
        self.processor_time = ticks / TICKS_PER_SECOND


def _children(process: int) -> List[int]:
    """Process ids; none where the kernel does not list them."""
    return [int(word) for words in _words_of(f"/proc/{process}/task/*/children") for word in words]


def _words_of(pattern: str) -> Iterator[List[str]]:
    """The words of each of these files, from behind a name in brackets."""
    for path in glob.glob(pattern):
        with contextlib.suppress(OSError):  # it has ended
            with open(path, errors="replace") as file:
                yield file.read().rpartition(")")[2].split()


def processor_time() -> float:
    """Processor time [s] of this process without the calling thread, and of its children at their last poll."""
    return _process_time() - _thread_time() + children.processor_time


children = ChildProcesses()
