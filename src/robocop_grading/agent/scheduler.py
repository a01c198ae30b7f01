"""Decides which thread of the process runs, what the others wait for, and when simulated time goes on."""

import _thread
import contextlib
import heapq
import itertools
import os
import time
from collections import deque
from typing import Any, Deque, Dict, Iterator, List, Optional, Set, Tuple

NEVER = 1 << 62  # [ns]
SECOND = 10**9  # [ns]
MONOTONIC_START = 2**14 * SECOND  # of the node's monotonic clock; asyncio's timeouts are exact below twice this value
SLACK = 50_000  # [ns] the shortest wait, as on Linux, so that rounding cannot stall a loop
Files = List[Tuple[int, int]]  # descriptors with the events of poll() that are waited for

# The system's own functions; the rest of the process finds those of locks.py, threads.py and clock.py instead.
allocate_lock, start_new_thread, sleep = _thread.allocate_lock, _thread.start_new_thread, time.sleep
_system: Any = _thread


class Waiter:
    """One wait of one thread: in its gate, which is opened when it has its turn."""

    __slots__ = ("thread", "awake", "gate", "granted", "files")

    def __init__(self, thread: int, files: Optional[Files] = None) -> None:
        self.thread = thread  # 0: one that has not begun
        self.awake = False
        self.granted = False  # it got what it waited for, before the deadline
        self.files: Files = files or []
        self.gate: Any = allocate_lock()
        self.gate.acquire()


class Scheduler:
    """One thread runs at a time, until it waits; then the next thread that was woken up has its turn.

        new_thread ---> queued ---> running ---> waiting      park: until it is woken, or a simulated time
                          ^           |  |          |
                          |           |  +-> ended  | wake
                          +-----------|-------------+
                                      +-> running in the background: it sleeps in an unknown way, or computes for
                                          long, and other threads have their turns meanwhile; until it waits or ends

    So the threads run in the same order in every run. Methods that say "with the guard held" have to be called so.
    """

    def __init__(self) -> None:
        # Recursive, because a destructor may run while it is held, which is for moments only.
        self.guard: Any = _system.RLock()
        # Both clocks begin at fixed values: how a time-out is rounded depends on the size of the clock's value. On a
        # machine that is up for 3 h, asyncio waits 0.101 s instead of 0.1 s; after 5 h it does not.
        self.epoch_ns, self.epoch_monotonic_ns = time.time_ns() // SECOND * SECOND, MONOTONIC_START
        self.active = True  # False in a forked child: the grader does not see it, and it lives on the wall clock
        self.now_ns = 0
        self.running: Set[int] = set()  # threads
        self.background: Set[int] = set()  # running threads beside which others have their turns
        self.calling: Set[int] = set()  # running threads that wait for the grader's answer, in no simulated time
        self.queue: Deque[Waiter] = deque()  # whose turns are next
        self.starting = 0  # threads that got their first turn and have not begun to run
        self.turns = 0  # so far
        self._sleepers: List[Tuple[int, int, Waiter]] = []  # a heap: deadline [ns], number in order of begin, wait
        self._numbers = itertools.count()
        self._spent: Dict[int, Tuple[int, float]] = {}  # by thread: a time [ns], and the share of work done at it
        self._idle = allocate_lock()  # released when the last thread has begun to wait
        os.register_at_fork(after_in_child=self._leave_alone)

    def _leave_alone(self) -> None:
        """In a forked child everything is as without the agent."""
        self.active = False

    # -- for the threads --

    def new_waiter(self) -> Waiter:
        """A wait of the calling thread."""
        return Waiter(_thread.get_ident())

    def deadline(self, timeout: Optional[float]) -> int:
        """The simulated time [ns] at which a wait that begins now ends."""
        if timeout is None or timeout > 1e9:
            return NEVER
        return self.now_ns + max(SLACK, int(round(timeout * 1e9)))

    def park(self, waiter: Waiter, until_ns: int = NEVER) -> None:
        """The calling thread is about to wait; with the guard held."""
        if until_ns < NEVER:
            self.end_wait_at(until_ns, waiter)
        self.leave()

    def end_wait_at(self, until_ns: int, waiter: Waiter) -> None:
        """Have a wait end at a simulated time, after the waits that already end at this time; with the guard held."""
        heapq.heappush(self._sleepers, (until_ns, next(self._numbers), waiter))

    def leave(self) -> None:
        """The calling thread no longer runs; with the guard held."""
        self.running.discard(_thread.get_ident())
        self.background.discard(_thread.get_ident())
        self._pass_on()

    def _pass_on(self) -> None:
        """Give the next thread its turn, unless a thread runs in the foreground; with the guard held."""
        if self.starting or not self.running <= self.background:
            return
        if self.queue:
            self.turns += 1
            waiter = self.queue.popleft()
            if waiter.thread:
                self.running.add(waiter.thread)
            else:
                self.starting += 1
            waiter.gate.release()
        elif self._idle.locked():
            self._idle.release()

    def wait(self, waiter: Waiter) -> None:
        """Wait for the next turn of the calling thread, which has parked."""
        try:
            waiter.gate.acquire()
        except BaseException:  # of a signal's handler
            with self.guard:
                waiter.awake = True
                if waiter in self.queue:
                    self.queue.remove(waiter)
                self.running.add(waiter.thread)
            raise

    def wake(self, waiter: Waiter) -> None:
        """End a thread's wait; with the guard held."""
        waiter.awake = True
        self.queue.append(waiter)
        self._pass_on()

    def pause(self, until_ns: int) -> None:
        """Wait for a simulated time."""
        waiter = self.new_waiter()
        with self.guard:
            self.park(waiter, until_ns)
        self.wait(waiter)

    def yield_turn(self) -> None:
        """Let the threads run that have been woken up, then go on: what sched_yield does."""
        waiter = self.new_waiter()
        with self.guard:
            if not self.queue:
                return
            self.wake(waiter)
            self.leave()
        self.wait(waiter)

    def spend(self, share: float, pause_s: float) -> None:
        """Note that the calling thread has done this share of what a thread can do at one simulated time.

        When the shares at one simulated time exceed 1, the thread waits for `pause_s` [s]. Work takes time in the
        lab, too: with this, a loop without pauses is as fast on each machine.
        """
        if not self.active:
            return
        me = _thread.get_ident()
        since_ns, spent = self._spent.get(me, (self.now_ns, 0.0))
        spent = share + (spent if since_ns == self.now_ns else 0.0)
        self._spent[me] = self.now_ns, spent
        if spent > 1.0:
            self.pause(self.deadline(pause_s))

    # -- for those who start threads --

    def new_thread(self) -> Waiter:
        """Queue the first turn of a thread that is about to be started; the thread begins with a call of begin()."""
        waiter = Waiter(0)
        with self.guard:
            self.wake(waiter)
        return waiter

    def begin(self, waiter: Waiter) -> None:
        """Wait for the calling thread's first turn."""
        waiter.gate.acquire()
        with self.guard:
            self.starting -= 1
            self.running.add(_thread.get_ident())

    def cancel_start(self, waiter: Waiter) -> None:
        """Drop the first turn of a thread that the system could not start."""
        with self.guard:
            if waiter in self.queue:
                self.queue.remove(waiter)
            else:
                self.starting -= 1
                self._pass_on()

    def end(self) -> None:
        """The calling thread ends."""
        with self.guard:
            self._spent.pop(_thread.get_ident(), None)  # the next one may have its number
            self.leave()

    # -- called by the thread that serves the grader, which is not scheduled --

    def wait_until_idle(self, timeout: float) -> bool:
        """Return whether all threads wait within `timeout` [s, wall]."""
        self._idle.acquire(False)
        with self.guard:
            if not self.running and not self.starting:
                return True
        self._idle.acquire(True, timeout)
        with self.guard:
            return not self.running and not self.starting

    def only_background_runs(self) -> bool:
        """Return whether every thread that runs is in the background."""
        with self.guard:
            return not self.starting and self.running <= self.background

    def move_to_background(self, threads: Set[int]) -> bool:
        """Move these threads to the background if no others run; return whether another thread got a turn, or runs."""
        with self.guard:
            if self.starting or self.running != threads:
                return True
            before = self.turns
            self.background.update(threads)
            self._pass_on()
            return self.turns != before

    def next_deadline(self) -> int:
        """The earliest simulated time [ns] that a thread waits for; NEVER if there is none."""
        with self.guard:
            while self._sleepers and self._sleepers[0][2].awake:  # woken otherwise
                heapq.heappop(self._sleepers)
            return self._sleepers[0][0] if self._sleepers else NEVER

    def wake_next(self) -> None:
        """Let simulated time go on to the earliest deadline, and wake the thread that waits for it."""
        with self.guard:
            self.now_ns = max(self.now_ns, self.next_deadline())
            self.wake(heapq.heappop(self._sleepers)[2])

    @contextlib.contextmanager
    def work(self) -> Iterator[None]:
        """A block in which the calling thread counts as running, so that the other threads wait for their turns."""
        with self.guard:
            self.running.add(_thread.get_ident())
        try:
            yield
        finally:
            with self.guard:
                self.leave()

    def advance(self, until_ns: int) -> None:
        """Let simulated time go on to a time; no thread may wait for an earlier time."""
        self.now_ns = max(self.now_ns, until_ns)


scheduler = Scheduler()
