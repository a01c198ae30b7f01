"""The last goals and what became of them."""

from collections import deque
from dataclasses import dataclass
from typing import Deque, Dict, List, Optional, Tuple

REMEMBERED = 8  # goals


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

    def position(self, goal_id: str) -> Optional[Tuple[float, float]]:
        """A goal's position [m] in the server's frame, if it was seen and is not too old.

        A goal without an id, as of `rostopic pub`, gets one from its server: the first that is asked for and unknown.
        """
        if goal_id not in self._goals and "" in self._goals:
            self._goals[goal_id] = self._goals.pop("")
        return self._goals.get(goal_id)

    def ended(self, robot: str, goal_id: str, state: str, message: str) -> None:
        """A result was received."""
        self._ended.appendleft(Ended(robot, state, message, self.position(goal_id)))

    def latest(self) -> List[Ended]:
        """The last goals, the newest first."""
        return list(self._ended)
