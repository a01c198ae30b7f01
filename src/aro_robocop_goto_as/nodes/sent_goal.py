"""One goal on its way, as its client sees it.

By ActionClient, not SimpleActionClient: that one takes a newer goal's first transition for an error if it comes before
the goal's handle is in place, and the older goal's last ones for the newer goal's.
"""

import threading
from typing import Callable, Optional

import actionlib
from actionlib import ClientGoalHandle, CommState
from actionlib_msgs.msg import GoalStatus
from geometry_msgs.msg import Point

from aro_robocop_goto_as.msg import GoToPositionFeedback, GoToPositionGoal, GoToPositionResult

from .ticker import wait_until

# Not GoalStatus.to_string: it calls PENDING, which is 0, by the first name whose value equals False.
STATES = {value: name for name, value in vars(GoalStatus).items() if name.isupper() and type(value) is int}
ACKNOWLEDGE_PATIENCE = 1.0  # [s, wall] for the server to have heard of a goal before it is asked to cancel it


class SentGoal:
    """Told apart from all others by its handle."""

    def __init__(self, client: actionlib.ActionClient, position: Point, on_end: Callable[[str], None],
                 on_feedback: Callable[[GoToPositionFeedback], None] = lambda feedback: None) -> None:
        self.position = position
        self.done = threading.Event()
        self.feedback: Optional[GoToPositionFeedback] = None
        self.result: Optional[GoToPositionResult] = None
        self._on_end = on_end
        self._on_feedback = on_feedback
        self._acknowledged = threading.Event()
        self._handle: ClientGoalHandle = client.send_goal(GoToPositionGoal(position), self._take_transition,
                                                          self._take_feedback)

    def cancel(self) -> None:
        """Ask for its end, once the server knows of it: of one cancelled before that, actionlib may think it LOST."""
        wait_until(self._acknowledged.is_set, ACKNOWLEDGE_PATIENCE)
        self._handle.cancel()

    def _take_transition(self, handle: ClientGoalHandle) -> None:
        self._acknowledged.set()
        if handle.get_comm_state() != CommState.DONE:
            return
        self.result = result = handle.get_result()
        state = STATES[handle.get_terminal_state()]
        self._on_end("{}{}".format(state, ": " + result.message if result is not None and result.message else ""))
        self.done.set()

    def _take_feedback(self, _handle: ClientGoalHandle, feedback: GoToPositionFeedback) -> None:
        self.feedback = feedback
        self._on_feedback(feedback)

    def __str__(self) -> str:
        state = STATES[self._handle.get_goal_status()]
        where = f"goal x {self.position.x:.2f} y {self.position.y:.2f} is {state}"
        feedback = self.feedback
        if feedback is None:
            return where
        errors = f"position_error {feedback.position_error:.2f} m, angle_error {feedback.angle_error:.2f} rad"
        return f"{where}: {feedback.message} ({errors})"
