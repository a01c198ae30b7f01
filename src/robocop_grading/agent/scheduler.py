"""Which of the process's threads run, for what the others wait, and simulated time.

A thread runs unless it has said that it waits. Whoever ends its wait (the release of a lock, simulated time) counts it
as running before it wakes up, so there is no moment at which work is on its way unseen.
"""

import _thread
import ctypes
import errno
import heapq
import itertools
import os
import select
import time
from contextlib import contextmanager
from typing import Any, Dict, Iterator, List, Optional, Set, Tuple

NEVER = 1 << 62  # [ns]
SLACK = 50_000  # [ns] the shortest wait, as on Linux: a loop that waits for what rounding has left of a time goes on
Files = List[Tuple[int, int]]  # descriptors with the events of poll() that are waited for
Link = Tuple[int, int]  # a TCP connection, by this process's port and the other one's


class Waiter:
    """One wait of one thread: in its gate, which somebody opens, or in poll()."""

    __slots__ = ("thread", "awake", "gate", "granted", "files", "alarm")

    def __init__(self, files: Optional[Files] = None) -> None:
        self.thread = _thread.get_ident()
        self.awake = False
        self.granted = False  # it got what it waited for: not the deadline ended the wait
        self.files: Files = files or []
        self.alarm = -1  # the end of a pipe, whose other end is one of the files that it waits for
        self.gate: Any = None
        if files is None:
            self.gate = allocate_lock()
            self.gate.acquire()


# The system's own, which everything else of the process no longer finds.
allocate_lock, start_new_thread, sleep, select_poll = (
    _thread.allocate_lock,
    _thread.start_new_thread,
    time.sleep,
    select.poll,
)
# Recursive, because a destructor may run while it is held, which is for moments only.
system: Any = _thread
guard: Any = system.RLock()

epoch_ns, epoch_monotonic_ns = time.time_ns(), time.monotonic_ns()  # at simulated time 0
active = True  # False in a forked child: the grader does not see it, and it lives on the wall clock
now_ns = 0
running: Set[int] = set()  # threads
woken = 0  # how often a thread was woken up, so far
starting = 0  # threads that were started and have not begun
calls = 0  # of the grader, so far
turn = 0  # number of the grader's requests that have been answered
calling: Dict[int, int] = {}  # threads that wait for an answer of the grader's own, by which they count as running
reading: Dict[int, Waiter] = {}  # threads in poll()
received: Dict[int, "Traffic"] = {}  # by descriptor
closed: List["Traffic"] = []  # since the last answer
expected: Dict[Link, int] = {}  # bytes that the grader has sent
_spent: Dict[int, Tuple[int, float]] = {}  # by thread: a simulated time [ns], and what it has done at that
_deadlines: List[Tuple[int, int, Waiter]] = []
_numbers = itertools.count()
_idle = allocate_lock()  # open when the last thread has begun to wait


class _PollEntry(ctypes.Structure):
    """`struct pollfd` of poll(2)."""

    _fields_ = [("fd", ctypes.c_int), ("events", ctypes.c_short), ("revents", ctypes.c_short)]


_poll_with_gil = ctypes.PyDLL(None, use_errno=True).poll  # PyDLL does not release the interpreter's lock


class Traffic:
    """What a socket has received and sent."""

    __slots__ = ("link", "received", "sent", "reported")

    def __init__(self, link: Optional[Link]) -> None:
        self.link = link
        self.received = self.sent = self.reported = 0  # bytes


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
    if not running and not starting and _idle.locked():
        _idle.release()


def wake(waiter: Waiter) -> None:
    """End a thread's wait; called with the guard held."""
    global woken
    woken += 1
    waiter.awake = True
    running.add(waiter.thread)
    if waiter.gate is not None:
        waiter.gate.release()
    elif waiter.alarm >= 0:
        os.write(waiter.alarm, b"x")


def _ready(files: Files) -> List[int]:
    """What is ready of each of these now, as events of poll(), without letting another thread run meanwhile."""
    entries = (_PollEntry * len(files))(*(_PollEntry(file, events) for file, events in files))
    while _poll_with_gil(entries, len(files), 0) < 0:
        if ctypes.get_errno() != errno.EINTR:  # a signal
            raise OSError(ctypes.get_errno(), "poll() of the descriptors that threads wait for")
    return [entry.revents for entry in entries]


def pause(until_ns: int) -> None:
    """Wait for a simulated time."""
    waiter = Waiter()
    with guard:
        park(waiter, until_ns)
    waiter.gate.acquire()


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


def poll(files: Files, timeout: Optional[float] = None) -> bool:
    """Wait until one of these is ready; False if `timeout` [s, simulated] is over before."""
    if any(_ready(files)):
        return True
    poller = select_poll()
    for file, events in files:
        poller.register(file, events)
    me = _thread.get_ident()
    if me in calling:
        poller.poll()
        return True
    if not active:
        return bool(poller.poll(None if timeout is None else timeout * 1e3))
    if timeout is not None and timeout <= 0.0:
        return False
    waiter = Waiter(files)
    listener = -1
    if timeout is not None:
        listener, waiter.alarm = os.pipe()
        poller.register(listener, select.POLLIN)
    try:
        with guard:
            reading[me] = waiter
            park(waiter, deadline(timeout))
        poller.poll()
    finally:
        with guard:
            reading.pop(me, None)
            in_time, waiter.awake = not waiter.awake, True
            running.add(me)
        if listener >= 0:
            os.close(listener)
            os.close(waiter.alarm)
    return in_time


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


def wait_for_work(timeout: float) -> None:
    """When every thread waits: wait until some have run and all wait again, for `timeout` [s, wall] at most."""
    _idle.acquire(True, timeout)


def nothing_arrives() -> bool:
    """Whether nothing is readable, or on its way, that a thread waits for; called with the guard held."""
    wanted = [file_and_events for waiter in reading.values() for file_and_events in waiter.files]
    for file, _ in wanted:
        traffic = received.get(file)
        if traffic is not None and traffic.link in expected and traffic.received < expected[traffic.link]:
            return False
    return all(events in (0, select.POLLNVAL) for events in _ready(wanted))  # a closed one wakes nobody


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
    global active, guard
    active, guard = False, type(guard)()


os.register_at_fork(after_in_child=leave_alone)
