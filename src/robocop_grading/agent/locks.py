"""Locks that tell the scheduler which threads wait; conditions, events, queues and semaphores use these locks."""

import threading
from collections import deque
from typing import Any, Deque

from .scheduler import Waiter, allocate_lock, scheduler


class Lock:
    """threading.Lock, with timeouts in simulated time."""

    def __init__(self) -> None:
        self._lock: Any = allocate_lock()
        self._waiters: Deque[Waiter] = deque()

    def acquire(self, blocking: bool = True, timeout: float = -1) -> bool:
        if timeout != -1 and (timeout < 0 or not blocking):
            return bool(self._lock.acquire(blocking, timeout))  # raises what it has to
        if self._lock.acquire(False):
            return True
        if not blocking or timeout == 0:
            return False
        if not scheduler.active:
            return bool(self._lock.acquire(True, timeout))
        waiter = scheduler.new_waiter()
        with scheduler.guard:
            self._waiters.append(waiter)  # before the second attempt: release() looks for it after releasing
            if self._lock.acquire(False):
                self._waiters.remove(waiter)
                return True
            scheduler.park(waiter, scheduler.deadline(None if timeout < 0 else timeout))
        scheduler.wait(waiter)
        return waiter.granted

    def release(self) -> None:
        self._lock.release()
        if self._waiters and scheduler.active:
            with scheduler.guard:
                while self._waiters and self._lock.acquire(False):
                    waiter = self._waiters.popleft()
                    if not waiter.awake:
                        waiter.granted = True  # the lock is its own now
                        scheduler.wake(waiter)
                        return
                    self._lock.release()

    def locked(self) -> bool:
        return bool(self._lock.locked())

    def __enter__(self) -> bool:
        return self.acquire()

    def __exit__(self, *_: object) -> None:
        self.release()

    def _at_fork_reinit(self) -> None:
        self._lock = allocate_lock()
        self._waiters = deque()


def install() -> None:
    """Make all modules that are imported from now on use these locks."""
    import _thread
    import queue

    module: Any = threading
    module.Lock = module._allocate_lock = Lock
    module._CRLock = None  # then threading.RLock is written in Python, around a Lock
    system: Any = _thread
    system.allocate_lock = system.allocate = Lock
    queues: Any = queue
    queues.SimpleQueue = queues._PySimpleQueue  # the other one waits in C
