"""The wall clock that simulated time is paced against; tests replace it by one that they move themselves."""

import queue
import time
from typing import Callable, Protocol

Job = Callable[[], object]
# Not SimpleQueue: before Python 3.12 its get(timeout) blocks for ever when a signal handler runs past the timeout.
Jobs = queue.Queue  # of Job


class Clock(Protocol):
    """A monotonic clock, and the one way in which the loop waits."""

    def now(self) -> float:
        """Seconds from an arbitrary origin."""

    def get(self, jobs: "Jobs[Job]", timeout: float) -> Job:
        """The next job; raises queue.Empty when none has come within `timeout` [s]."""


class WallClock:
    """The machine's own clock."""

    def now(self) -> float:
        """Seconds from an arbitrary origin."""
        return time.monotonic()

    def get(self, jobs: "Jobs[Job]", timeout: float) -> Job:
        """The next job; raises queue.Empty when none has come within `timeout` [s]."""
        return jobs.get(timeout=timeout) if timeout > 0.0 else jobs.get_nowait()
