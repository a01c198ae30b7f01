"""Functions that other threads hand to a simulation's thread, which runs them between two steps."""

import contextlib
import queue
import time
from concurrent.futures import Future, TimeoutError
from typing import Callable, TypeVar

from ..errors import RobocopError, ShutdownError

# Not SimpleQueue: before Python 3.12 its get(timeout) blocks for ever when a signal handler runs past the timeout.
Queue = queue.Queue  # of jobs
CALL_POLL = 0.1  # [s, wall] between two checks for a shutdown while another thread waits for its job

T = TypeVar("T")


class WallClock:
    """The machine's monotonic clock, and how the simulation thread waits; tests use a clock that they move."""

    def now(self) -> float:
        """Seconds from an arbitrary origin."""
        return time.monotonic()

    def sleep(self, seconds: float) -> None:
        """Wait, whatever jobs come."""
        time.sleep(seconds)

    def get(self, jobs: "Queue[Callable[[], object]]", timeout: float) -> Callable[[], object]:
        """The next job; raises queue.Empty when none has come within `timeout` [s]."""
        return jobs.get(timeout=timeout) if timeout > 0.0 else jobs.get_nowait()


class Jobs:
    """Any thread may use `post`, `call` and `wait_for`; all else is for the simulation thread."""

    def __init__(self, clock: WallClock, stopped: Callable[[], bool] = lambda: False) -> None:
        """`stopped`: whether the simulation thread's loop has ended, so that nobody will run jobs any more."""
        self._clock = clock
        self._stopped = stopped
        self._queue: Queue[Callable[[], object]] = queue.Queue()
        self.post: Callable[[Callable[[], object]], None] = self._queue.put  # has the simulation thread run a job

    def call(self, function: Callable[[], T]) -> T:
        """Have the simulation thread run a function; returns what it returns, raises the RobocopError that it raises.

        Any other exception is a programming error and ends the simulation thread's loop.
        """
        future: Future[T] = Future()

        def job() -> None:
            try:
                future.set_result(function())
            except RobocopError as error:
                future.set_exception(error)

        self.post(job)
        return self.wait_for(future)

    def wait_for(self, future: "Future[T]") -> T:
        """The result that the simulation thread sets; ShutdownError when its loop has ended instead."""
        while not self._stopped():
            with contextlib.suppress(TimeoutError):
                return future.result(timeout=CALL_POLL)
        raise ShutdownError("the simulator is shutting down")

    def __len__(self) -> int:
        return self._queue.qsize()

    def run_next(self, timeout: float) -> None:
        """Run the next job, if there is one within `timeout` [s, wall]."""
        try:
            job = self._clock.get(self._queue, timeout)
        except queue.Empty:
            return
        job()

    def run_queued(self) -> None:
        """Run the jobs that are queued now, and no more: their senders may be faster than the simulation thread."""
        for _ in range(len(self)):
            self._queue.get_nowait()()
