"""Results: of one simulation, of one floor, of all repeats of a case."""

from dataclasses import dataclass, field
from typing import Dict, List, Optional

from .cases import Case

BUSY = 0.9  # share of a processor from which on the client may limit the speed
KEPT_UP = 0.95  # a lower share of the requested real-time factor is noted


@dataclass(frozen=True)
class Run:
    """The result of one simulation."""

    factor: float  # simulated seconds per second of the wall clock
    cpu: float  # [s] of processor time per simulated second, user and system
    memory: int  # [bytes] peak
    first_scan: float  # [s, wall] from the process's start to the first scan
    expected: int  # messages, from simulated time and rates
    delivered: int
    client_busy: float  # share of a processor; near 1 the client limits the speed


@dataclass(frozen=True)
class Floor:
    """The result of the bare parts."""

    factor: float  # simulated seconds per second of the wall clock
    cpu: float  # [s] of processor time per simulated second
    step: float  # [s, wall] per physics step of all robots
    scan: float  # [s, wall] per scan of one robot
    message: float  # [s, wall] per message


@dataclass
class Measured:
    """All repeats of a case: floor, as fast as possible, at real-time factor 1; or the error that stopped them."""

    case: Case
    floors: List[Floor] = field(default_factory=list)
    fastest: List[Run] = field(default_factory=list)
    paced: List[Run] = field(default_factory=list)
    error: Optional[str] = None

    def figures(self) -> Dict[str, List[float]]:
        """The figures of the table, with a value for each repeat."""
        return {
            "factor": [run.factor for run in self.fastest],
            "floor": [floor.factor for floor in self.floors],
            "of_floor": [run.factor / floor.factor for run, floor in zip(self.fastest, self.floors)],
            "cpu_ms": [run.cpu * 1e3 for run in self.paced],
            "memory_mb": [max(run.memory, other.memory) / 1e6 for run, other in zip(self.fastest, self.paced)],
            "first_scan_s": [run.first_scan for run in self.paced],
        }

    @property
    def delivered(self) -> int:
        """Messages of all runs."""
        return sum(run.delivered for run in self.fastest + self.paced)

    @property
    def lost(self) -> int:
        """Messages expected by simulated time and not delivered, of all runs."""
        return sum(run.expected for run in self.fastest + self.paced) - self.delivered

    def notes(self) -> List[str]:
        """Remarks on the figures."""
        notes = []
        if self.error is not None:
            notes.append(f"{self.case.name} failed: {self.error}")
        if any(run.client_busy > BUSY for run in self.fastest):
            notes.append(f"{self.case.name}: the client was busy all the time, so it may limit the factor")
        slowest = min((run.factor for run in self.paced), default=1.0)
        if slowest < KEPT_UP:
            notes.append(f"{self.case.name}: only {slowest:.2f} of the requested factor 1 reached")
        return notes
