"""Whose turn it is of the process's threads, for what the others wait, and simulated time.

One thread runs at a time, until it waits; then the next one that has been woken up has its turn. So the threads meet in
the same order in every run. A thread that sleeps in an unknown way, or computes for long, is not waited for any more.
"""

import _thread
import heapq
import itertools
import os
import time
from collections import deque
from contextlib import contextmanager
from typing import Any, Deque, Dict, Iterator, List, Optional, Set, Tuple

NEVER = 1 << 62  # [ns]
SLACK = 50_000  # [ns] the shortest wait, as on Linux: a loop that waits for what rounding has left of a time goes on
Files = List[Tuple[int, int]]  # descriptors with the events of poll() that are waited for


class Waiter:
    """One wait of one thread: in its gate, which is opened when it has its turn."""

    __slots__ = ("thread", "awake", "gate", "granted", "files", "receives")

    def __init__(self, thread: int, files: Optional[Files] = None, receives: bool = False) -> None:
        self.thread = thread  # 0: one that has not begun
        self.awake = False
        self.granted = False  # it got what it waited for: not the deadline ended the wait
        self.files: Files = files or []
        self.receives = receives  # from a single one, whose end ends the wait
        self.gate: Any = allocate_lock()
        self.gate.acquire()


# The system's own, which everything else of the process no longer finds.
allocate_lock, start_new_thread, sleep = _thread.allocate_lock, _thread.start_new_thread, time.sleep
# Recursive, because a destructor may run while it is held, which is for moments only.
system: Any = _thread
guard: Any = system.RLock()

epoch_ns, epoch_monotonic_ns = time.time_ns(), time.monotonic_ns()  # at simulated time 0
active = True  # False in a forked child: the grader does not see it, and it lives on the wall clock
now_ns = 0
running: Set[int] = set()  # threads
unawaited: Set[int] = set()  # those of them that nobody waits for
queue: Deque[Waiter] = deque()  # whose turns are next
starting = 0  # threads that have their first turn, and have not begun
turns = 0  # so far
calls = 0  # of the grader, so far
requests = 0  # of the grader's that have been answered
calling: Dict[int, int] = {}  # threads that wait for an answer of the grader's own, by which they count as running
_spent: Dict[int, Tuple[int, float]] = {}  # by thread: a simulated time [ns], and what it has done at that
_deadlines: List[Tuple[int, int, Waiter]] = []
_numbers = itertools.count()
_idle = allocate_lock()  # open when the last thread has begun to wait


def this_thread() -> Waiter:
    """A wait of the calling thread."""
    return Waiter(_thread.get_ident())


def deadline(timeout: Optional[float]) -> int:
    """The simulated time [ns] at which a wait that begins now ends."""
    return NEVER if timeout is None or timeout > 1e9 else now_ns + max(SLACK, int(round(timeout * 1e9)))


def park(waiter: Waiter, until_ns: int) -> None:
    """The calling thread is about to wait; called with the guard held."""
    if until_ns < NEVER:
        heapq.heappush(_deadlines, (until_ns, next(_numbers), waiter))
    leave()


def leave() -> None:
    """The calling thread no longer runs; called with the guard held."""
    running.discard(_thread.get_ident())
    unawaited.discard(_thread.get_ident())
    pass_on()


def pass_on() -> None:
    """Let the next thread have its turn, unless one that is waited for runs; called with the guard held."""
    global starting, turns
    if starting or not running <= unawaited:
        return
    if queue:
        turns += 1
        waiter = queue.popleft()
        if waiter.thread:
            running.add(waiter.thread)
        else:
            starting += 1
        waiter.gate.release()
    elif _idle.locked():
        _idle.release()


def wait(waiter: Waiter) -> None:
    """Wait for the calling thread's next turn, when it has parked."""
    try:
        waiter.gate.acquire()
    except BaseException:  # of a signal's handler
        with guard:
            waiter.awake = True
            if waiter in queue:
                queue.remove(waiter)
            running.add(waiter.thread)
        raise


def wake(waiter: Waiter) -> None:
    """End a thread's wait; called with the guard held."""
    waiter.awake = True
    queue.append(waiter)
    pass_on()


def new_thread() -> Waiter:
    """The first turn of a thread that is about to be started, which calls begin() at first."""
    waiter = Waiter(0)
    with guard:
        wake(waiter)
    return waiter


def begin(waiter: Waiter) -> None:
    """Wait for the calling thread's first turn."""
    global starting
    waiter.gate.acquire()
    with guard:
        starting -= 1
        running.add(_thread.get_ident())


def no_thread(waiter: Waiter) -> None:
    """The system did not start a thread."""
    global starting
    with guard:
        if waiter in queue:
            queue.remove(waiter)
        else:
            starting -= 1
            pass_on()


def pause(until_ns: int) -> None:
    """Wait for a simulated time."""
    waiter = this_thread()
    with guard:
        park(waiter, until_ns)
    wait(waiter)


def give_way() -> None:
    """Let the threads run that have been woken up."""
    waiter = this_thread()
    with guard:
        if not queue or waiter.thread in calling:
            return
        wake(waiter)
        leave()
    wait(waiter)


def spend(share: float, pause_s: float) -> None:
    """The calling thread has done this share of what a thread can do at one simulated time; then it waits [s].

    Work takes time in the lab, too: a loop without pauses that calls this is as fast on each machine.
    """
    if not active:
        return
    me = _thread.get_ident()
    since_ns, spent = _spent.get(me, (now_ns, 0.0))
    spent = share + (spent if since_ns == now_ns else 0.0)
    _spent[me] = now_ns, spent
    if spent > 1.0 and me not in calling:
        pause(deadline(pause_s))


@contextmanager
def call() -> Iterator[None]:
    """While this lasts the calling thread waits for the grader itself, which answers without simulated time."""
    global calls
    me = _thread.get_ident()
    calling[me] = calling.get(me, 0) + 1
    try:
        yield
    finally:
        calls += 1
        calling[me] -= 1
        if not calling[me]:
            del calling[me]


def end() -> None:
    """The calling thread ends."""
    with guard:
        _spent.pop(_thread.get_ident(), None)  # the next one may have its number
        leave()


# -- for the thread that answers the grader --


def wait_until_idle(timeout: float) -> bool:
    """Wait until every thread waits, for `timeout` [s, wall] at most; whether it is so."""
    _idle.acquire(False)
    with guard:
        if not running and not starting:
            return True
    _idle.acquire(True, timeout)
    with guard:
        return not running and not starting


def is_unawaited() -> bool:
    """Whether all threads that run are such that nobody waits for them."""
    with guard:
        return not starting and running <= unawaited


def wait_for_none_of(threads: Set[int]) -> bool:
    """Nobody waits any more for these threads, if it is they that run; whether another one has its turn."""
    with guard:
        if starting or running != threads:
            return True
        before = turns
        unawaited.update(threads)
        pass_on()
        return turns != before


def next_deadline() -> int:
    """The earliest simulated time [ns] that a thread waits for."""
    with guard:
        while _deadlines and _deadlines[0][2].awake:
            heapq.heappop(_deadlines)
        return _deadlines[0][0] if _deadlines else NEVER


def wake_next() -> None:
    """Let simulated time go on to the earliest deadline, and wake the thread that waits for it."""
    global now_ns
    with guard:
        now_ns = max(now_ns, next_deadline())
        wake(heapq.heappop(_deadlines)[2])


@contextmanager
def work() -> Iterator[None]:
    """While this lasts the calling thread is one of those that run, also the grader's, of which nothing else knows."""
    me = _thread.get_ident()
    with guard:
        runs = me in running
        running.add(me)
    try:
        yield
    finally:
        if not runs:
            with guard:
                leave()


def advance(until_ns: int) -> None:
    """Let simulated time go on; no thread waits for a time in between."""
    global now_ns
    now_ns = max(now_ns, until_ns)


def leave_alone() -> None:
    """In a forked child, which has none of the other threads: everything is as without the agent."""
    global active, guard, starting
    active, guard, starting = False, type(guard)(), 0
    running.clear()
    unawaited.clear()
    queue.clear()
    calling.clear()


os.register_at_fork(after_in_child=leave_alone)
