"""A goal from the client's side: sent, followed, cancelled.

Uses ActionClient because SimpleActionClient has two races: it reports an error when a newer goal's first transition
arrives before that goal's handle is stored, and it mistakes the older goal's last transitions for the newer goal's.
"""

import math
import threading
from typing import Callable, Optional

import actionlib
from actionlib import ClientGoalHandle, CommState
from actionlib_msgs.msg import GoalStatus
from geometry_msgs.msg import Point

from aro_robocop_goto_as.msg import GoToPositionFeedback, GoToPositionGoal, GoToPositionResult

from ..ticker import wait_until
from .discovery import kept_from_answering

# Not GoalStatus.to_string: for PENDING, which is 0, it returns the first name whose value equals False.
STATES = {value: name for name, value in vars(GoalStatus).items() if name.isupper() and type(value) is int}
UNFINISHED = ("PENDING", "ACTIVE", "PREEMPTING", "RECALLING")
# [s, wall, and then processor] for the server to acknowledge a goal before it is cancelled
ACKNOWLEDGE_PATIENCE = 1.0
LOOK = 0.1  # [s, wall] between two looks whether the server, or a callback, waits for a processor


class SentGoal:
    """One goal that was sent to the server, with its newest feedback and its result."""

    def __init__(
        self,
        client: actionlib.ActionClient,
        position: Point,
        where: str,
        on_end: Callable[[str], None] = lambda ending: None,
        on_feedback: Callable[[GoToPositionFeedback], None] = lambda feedback: None,
    ) -> None:
        """Send a goal at a position in the server's frame; `where`: its place as the user gave it, for reports."""
        self._client, self._where = client, where
        self.done = threading.Event()
        self.ending = ""  # state and message, once it is done
        self.feedback: Optional[GoToPositionFeedback] = None
        self.result: Optional[GoToPositionResult] = None
        self._on_end = on_end
        self._on_feedback = on_feedback
        self._acknowledged = threading.Event()
        self._handle: ClientGoalHandle = client.send_goal(
            GoToPositionGoal(position), self._handle_transition, self._handle_feedback
        )

    def cancel(self) -> None:
        """Request the goal's end once the server knows the goal: before that, actionlib may report it as LOST.

        One that does nothing, as it is stopped or broken, is not waited for: a program may have to end meanwhile.
        """
        acknowledged = self._acknowledged.is_set
        if not wait_until(acknowledged, ACKNOWLEDGE_PATIENCE):
            kept = kept_from_answering(self._client, ACKNOWLEDGE_PATIENCE)
            wait_until(lambda: acknowledged() or not kept(), math.inf, LOOK)
        self._handle.cancel()

    def _handle_transition(self, handle: ClientGoalHandle) -> None:
        self._acknowledged.set()
        if handle.get_comm_state() != CommState.DONE:
            return
        self.result = result = handle.get_result()
        state = STATES[handle.get_terminal_state()]
        self.ending = f"{state}: {result.message}" if result is not None and result.message else state
        self._on_end(self.ending)
        self.done.set()

    def _handle_feedback(self, _handle: ClientGoalHandle, feedback: GoToPositionFeedback) -> None:
        self.feedback = feedback
        self._on_feedback(feedback)

    def __str__(self) -> str:
        state = STATES[self._handle.get_goal_status()]
        goal = f"goal {self._where}"
        if state not in UNFINISHED:
            return f"{goal} has ended ({state}), waiting for its result"
        feedback = self.feedback
        if feedback is None:
            return f"{goal} is {state}"
        errors = f"position_error {feedback.position_error:.2f} m, angle_error {feedback.angle_error:.2f} rad"
        return f"{goal} is {state}: {feedback.message} ({errors})"
