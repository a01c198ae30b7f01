"""What was measured: one simulation, one floor, all repeats of a case."""

from dataclasses import dataclass, field
from typing import Dict, List, Optional

from .cases import Case

BUSY = 0.9  # share of a processor from which on the client may be what limits
KEPT_UP = 0.95  # a real-time factor below this share of the one asked for is said


@dataclass(frozen=True)
class Run:
    """One simulation."""

    factor: float  # simulated seconds in a second of the wall clock
    cpu: float  # [s] of processor time for a simulated second, user and system
    memory: int  # [bytes] at its peak
    first_scan: float  # [s, wall] from the process's start until the first scan was there
    expected: int  # messages, by simulated time
    delivered: int
    client_busy: float  # share of a processor that the client took; near 1 it would be what is measured


@dataclass(frozen=True)
class Floor:
    """What the bare parts take."""

    factor: float  # simulated seconds in a second of the wall clock
    cpu: float  # [s] of processor time for a simulated second
    step: float  # [s, wall] a physics step of all robots
    scan: float  # [s, wall] a robot's scan
    message: float  # [s, wall] a message written


@dataclass
class Measured:
    """All repeats of a case: its floor, at the highest factor, at factor 1; or why there are not as many."""

    case: Case
    floors: List[Floor] = field(default_factory=list)
    fastest: List[Run] = field(default_factory=list)
    paced: List[Run] = field(default_factory=list)
    error: Optional[str] = None

    def figures(self) -> Dict[str, List[float]]:
        """What the table shows medians of: a value for each repeat."""
        return {
            "factor": [run.factor for run in self.fastest],
            "floor": [floor.factor for floor in self.floors],
            "of_floor": [run.factor / floor.factor for run, floor in zip(self.fastest, self.floors)],
            "cpu_ms": [run.cpu * 1e3 for run in self.paced],
            "memory_mb": [max(run.memory, other.memory) / 1e6 for run, other in zip(self.fastest, self.paced)],
            "first_scan_s": [run.first_scan for run in self.paced]}

    @property
    def delivered(self) -> int:
        """Messages, of all runs."""
        return sum(run.delivered for run in self.fastest + self.paced)

    @property
    def lost(self) -> int:
        """Messages expected by simulated time and not delivered, of all runs."""
        return sum(run.expected for run in self.fastest + self.paced) - self.delivered

    def notes(self) -> List[str]:
        """What a reader has to know about the figures."""
        found = []
        if self.error is not None:
            found.append(f"{self.case.name} failed: {self.error}")
        if any(run.client_busy > BUSY for run in self.fastest):
            found.append(f"{self.case.name}: the client was busy all the time, so the factor may be the client's")
        slowest = min((run.factor for run in self.paced), default=1.0)
        if slowest < KEPT_UP:
            found.append(f"{self.case.name}: factor 1 was asked for and only {slowest:.2f} reached")
        return found
