"""Paces simulated time against the wall clock and measures the real-time factor reached."""

import time
from dataclasses import dataclass
from typing import Callable, Optional

REPORT_PERIOD = 1.0  # [s, wall]
MOST_BEHIND = 0.1  # [s, wall] a longer lag is dropped instead of being made up for in a burst
REST_PERIOD, REST = 0.01, 1e-4  # [s, wall] a simulation that never waits rests this often, for this long
TOLERANCE = 0.95  # share of the requested factor, below which the simulation counts as behind


@dataclass(frozen=True)
class FactorReport:
    """Real-time factor reached over the last period, and the requested one (0 = as fast as possible)."""

    reached: float
    asked: float
    step_time: float  # [s, wall] of work per step, without waiting
    lag: float  # [s, wall] behind the requested factor

    @property
    def behind(self) -> bool:
        """Whether the machine is too slow for the requested factor."""
        return self.asked > 0.0 and self.reached < TOLERANCE * self.asked


class Pacer:
    """Keeps simulated time at `factor` times the wall clock; factor 0 waits for rests only.

    A rest lets the process's other threads run, which accept subscribers and receive commands. CPython takes the
    interpreter from a thread that has kept it for 5 ms. A thread that gives it up for microseconds, and often, as numpy
    does, begins these 5 ms anew each time, and the others, too slow to wake up, can wait for minutes.
    """

    def __init__(self, factor: float, now: Callable[[], float] = time.monotonic) -> None:
        self.factor = factor
        self.now = now  # [s, wall]
        self.restart(0.0)

    def restart(self, simulated: float) -> None:
        """Start counting at this simulated time [s], as after a pause."""
        wall = self.now()
        self._anchor_wall, self._anchor_simulated = wall, simulated
        self._report_wall, self._report_simulated = wall, simulated
        self._report_steps: Optional[int] = None
        self._waited = 0.0
        self._rested = wall
        self._lag = 0.0

    def ahead(self, simulated: float) -> float:
        """How long to wait [s, wall] before simulated time `simulated` [s]: until it is due, or for a rest."""
        wall = self.now()
        ahead = self._until_due(simulated, wall)
        if ahead == 0.0 and wall - self._rested >= REST_PERIOD:
            ahead = REST
        if ahead > 0.0:
            self._rested = wall + ahead
        return ahead

    def _until_due(self, simulated: float, wall: float) -> float:
        if self.factor == 0.0:
            return 0.0
        due = self._anchor_wall + (simulated - self._anchor_simulated) / self.factor
        self._lag = max(0.0, wall - due)
        if wall - due > MOST_BEHIND:
            self._anchor_wall, self._anchor_simulated = wall, simulated
        return max(0.0, due - wall)

    def waited(self, seconds: float) -> None:
        """Add time [s, wall] spent waiting, which does not count as work."""
        self._waited += seconds
        if seconds >= REST:
            self._rested = self.now()

    def report(self, simulated: float, steps: int) -> Optional[FactorReport]:
        """The factor since the last report; None until a report period has passed."""
        wall = self.now()
        elapsed = wall - self._report_wall
        if elapsed < REPORT_PERIOD:
            return None
        reached = (simulated - self._report_simulated) / elapsed
        done = steps - self._report_steps if self._report_steps is not None else 0
        step_time = max(0.0, elapsed - self._waited) / done if done > 0 else 0.0
        self._report_wall, self._report_simulated, self._report_steps, self._waited = wall, simulated, steps, 0.0
        return FactorReport(reached, self.factor, step_time, self._lag)
