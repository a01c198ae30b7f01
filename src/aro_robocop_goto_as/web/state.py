"""What the page says about the system, as plain values."""

from collections import deque
from dataclasses import dataclass
from typing import Deque, Dict, List, Optional, Tuple

REMEMBERED = 8  # goals
SILENCE = 4.0  # [s, wall] without a report of the simulator, which sends one per second, until it counts as gone


@dataclass(frozen=True)
class SimState:
    """A report of the simulator; `at` is when it was received [s, monotonic]."""

    at: float
    time: float  # [s] simulated
    world: str
    robots: Tuple[str, ...]
    seed: int
    drive: str
    sync: str
    paused: bool
    factor_asked: float
    factor_reached: float

    def silent_for(self, now: float) -> float:
        """How long the simulator has sent no report [s], 0 while it reports as usual."""
        return now - self.at if now - self.at > SILENCE else 0.0


@dataclass(frozen=True)
class ReplayState:
    """A recording that is played: where it is and how long it is [s, recorded], and how fast it goes."""

    position: float
    duration: float
    playing: bool
    speed: float


@dataclass(frozen=True)
class Ended:
    """A goal that has ended."""

    robot: str
    state: str  # of actionlib, as SUCCEEDED
    message: str
    goal: Optional[Tuple[float, float]]  # [m] in the server's frame, if it was seen


class GoalHistory:
    """Goals and results by their actionlib ids."""

    def __init__(self) -> None:
        self._goals: Dict[str, Tuple[float, float]] = {}
        self._ended: Deque[Ended] = deque(maxlen=REMEMBERED)

    def sent(self, goal_id: str, x: float, y: float) -> None:
        """A goal was sent to a server [m]."""
        self._goals[goal_id] = (x, y)
        for oldest in list(self._goals)[:-REMEMBERED]:
            del self._goals[oldest]

    def ended(self, robot: str, goal_id: str, state: str, message: str) -> None:
        """A result was received."""
        self._ended.appendleft(Ended(robot, state, message, self._goals.pop(goal_id, None)))

    def clear(self) -> None:
        """Forget all goals."""
        self._goals, self._ended = {}, deque(maxlen=REMEMBERED)

    def latest(self) -> List[Ended]:
        """The last goals, the newest first."""
        return list(self._ended)
