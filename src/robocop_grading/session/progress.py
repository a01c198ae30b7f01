"""For how long the robot has made no progress towards the goals that have not ended."""

from typing import Dict, Sequence

from aro_robocop_goto_as.geometry import Pose2D
from aro_robocop_goto_as.goto.rule import Errors, LastProgress, track_progress

from ..handout import Limits
from ..record import SentGoal


class Progress:
    """The newest progress towards each goal that has not ended: a server may still drive to an older goal."""

    def __init__(self, limits: Limits) -> None:
        self._limits = limits
        self._newest: Dict[str, LastProgress] = {}  # by goal

    def missing_for(self, pose: Pose2D, running: Sequence[SentGoal], now: float) -> float:
        """How long [s] there has been no progress towards any goal at a time [s]; it starts anew when a goal ends."""
        if not self._newest.keys() <= {goal.id for goal in running}:
            self._newest = {}
        for goal in running:
            errors, least = Errors(*goal.errors_at(pose)), (self._limits.stall_distance, self._limits.stall_angle)
            self._newest[goal.id] = track_progress(self._newest.get(goal.id), errors, now, *least)
        return now - max((it.since for it in self._newest.values()), default=now)
