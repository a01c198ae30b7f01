"""Paces simulated time against the wall clock and measures the real-time factor reached."""

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

    def __init__(self, factor: float, rate: int, now: Callable[[], float]) -> None:
        """`rate` [Hz] of the steps; `now`: the wall clock [s]."""
        self.factor = factor
        self.now = now
        self._rate = rate
        self.restart(0)

    def restart(self, step: int) -> None:
        """Start counting at this step, as after a pause."""
        self._anchor_wall, self._anchor_step = self.now(), step
        self._report_wall, self._report_step = self._anchor_wall, step
        self._rested = self._anchor_wall
        self._waited = self._lag = 0.0

    def ahead(self, step: int) -> float:
        """How long to wait [s, wall] before going on from a step: until it is due, or for a rest."""
        wall = self.now()
        ahead = self._until_due(step, wall)
        if ahead == 0.0 and wall - self._rested >= REST_PERIOD:
            ahead = REST
        if ahead > 0.0:
            self._rested = wall + ahead
        return ahead

    def _until_due(self, step: int, wall: float) -> float:
        if self.factor == 0.0:
            return 0.0
        due = self._anchor_wall + (step - self._anchor_step) / self._rate / self.factor
        self._lag = max(0.0, wall - due)
        if wall - due > MOST_BEHIND:
            self._anchor_wall, self._anchor_step = wall, step
        return max(0.0, due - wall)

    def waited(self, seconds: float) -> None:
        """Add time [s, wall] spent waiting, which does not count as work."""
        self._waited += seconds
        if seconds >= REST:
            self._rested = self.now()

    def report(self, step: int) -> Optional[FactorReport]:
        """The factor since the last report; None until a report period has passed."""
        wall = self.now()
        elapsed = wall - self._report_wall
        if elapsed < REPORT_PERIOD:
            return None
        done = step - self._report_step
        step_time = max(0.0, elapsed - self._waited) / done if done > 0 else 0.0
        self._report_wall, self._report_step, self._waited = wall, step, 0.0
        return FactorReport(done / self._rate / elapsed, self.factor, step_time, self._lag)
