"""The GoToPosition action server: SimpleActionServer, but robust against clock resets, and without empty results."""

from typing import Any

import actionlib

from aro_robocop_goto_as.msg import GoToPositionAction, GoToPositionResult

from .. import private_api
from ..action import ACTION
from ..timer import start_timer

RESULTS_KEPT = 10_000  # for a subscriber that is slow, some 3 MB: a goal without a result keeps its client waiting


class GoalServer(actionlib.SimpleActionServer):
    """A SimpleActionServer without an execute callback: its owner accepts goals and ends them."""

    def __init__(self, not_started: GoToPositionResult) -> None:
        """`not_started` is the result of goals that were cancelled or replaced before they were accepted."""
        super().__init__(ACTION, GoToPositionAction, auto_start=False)
        private_api.set_default_result(self, lambda: not_started)
        private_api.ignore_future_cancels(self)

    def start(self) -> None:
        """Begin to receive goals."""
        super().start()
        private_api.keep_results(self, RESULTS_KEPT)
        private_api.replace_status_timer(self, start_timer)

    def internal_goal_callback(self, goal: Any) -> None:
        """Receive a goal: the one that arrives last counts, whatever its stamp."""
        private_api.forget_later_stamps(self, goal)
        super().internal_goal_callback(goal)
