"""The GoToPosition action server: actionlib's, for one goal at a time, robust against floods and clock resets.

What a goal is refused for, and how it ends, is up to goal_execution.

It overrides and sets private parts of actionlib, which has no public way to any of this.
"""

from collections import deque
from functools import partial
from typing import Any, Callable, Deque, List, cast

import actionlib
import rospy
from actionlib import ServerGoalHandle
from actionlib_msgs.msg import GoalStatus

from aro_robocop_goto_as.msg import GoToPositionAction, GoToPositionGoal, GoToPositionResult

from ...goto import Outcome
from ..names import ACTION
from ..rospy_internals import lengthen_queue
from ..ticker import start_timer

# For a subscriber that is slow, some 3 MB: a goal without a result keeps its client waiting. actionlib keeps 50.
RESULTS_KEPT = 10_000
# Ended goals in the status. actionlib keeps all for 5 s and looks through them for each goal, cancel and status.
ENDED_KEPT = 200
# The result of goals that were cancelled or replaced before they were accepted.
NOT_STARTED = GoToPositionResult(False, f"{Outcome.PREEMPTED.value}: it was cancelled or replaced before it started")
UNFINISHED = (GoalStatus.PENDING, GoalStatus.ACTIVE, GoalStatus.PREEMPTING)


class GoalServer(actionlib.ActionServer):
    """One goal is current, at most one is waiting: the one that arrived last, whatever its stamp.

    Subscribers only queue what arrives. receive() takes all of it at once, so that a flood of goals costs one change of
    goals and one status message. It and the methods below it belong to one thread, the control loop.
    """

    last_cancel: Any
    status_list: List[Any]
    status_timer: Any

    def __init__(self) -> None:
        super().__init__(ACTION, GoToPositionAction, self._on_new_goal, self._on_cancel, auto_start=False)
        self.ActionResultType = lambda: NOT_STARTED  # of goals that actionlib ends; its own is empty
        self.current: Any = None  # ServerGoalHandle, or None
        self.waiting: Any = None
        self.is_cancelled = False  # the current goal
        self._arrived: Deque[Callable[[], None]] = deque()
        self._receiving = False

    def start(self) -> None:
        """Begin to receive goals."""
        super().start()
        lengthen_queue(self.result_pub, RESULTS_KEPT)
        if self.status_timer is not None:  # actionlib's timer ends for good when the clock is set back
            self.status_timer.shutdown()
            self.status_timer = start_timer(1.0 / self.status_frequency, lambda: self.publish_status_async(None))

    def internal_goal_callback(self, goal: Any) -> None:
        """Queue a goal; a callback."""
        self._arrived.append(partial(self._take_goal, goal))

    def internal_cancel_callback(self, goal_id: Any) -> None:
        """Queue a cancel; a callback."""
        self._arrived.append(partial(self._take_cancel, goal_id))

    def has_request(self) -> bool:
        """Whether there is something to receive, or a goal to accept."""
        return bool(self._arrived) or self.waiting is not None

    def receive(self) -> None:
        """Take the goals and cancels that have arrived, in their order: sets `waiting` and `is_cancelled`."""
        with self.lock:
            self._receiving = True
            try:
                for _ in range(len(self._arrived)):
                    self._forget_oldest()
                    self._arrived.popleft()()
            finally:
                self._receiving = False
                self.publish_status()

    def publish_status(self) -> None:
        """Publish the status of the goals, once for all that are received together: results carry their own."""
        if not self._receiving:
            super().publish_status()

    def _take_goal(self, goal: Any) -> None:
        # actionlib recalls every goal stamped before the latest cancel's stamp: after the clock was set back that is
        # every goal. A cancel with a stamp in the future affects only goals received before it.
        if self.last_cancel > rospy.get_rostime():
            self.last_cancel = rospy.Time()
        super().internal_goal_callback(goal)

    def _take_cancel(self, goal_id: Any) -> None:
        # Of ended goals, and of cancels whose goal has not come, there is nothing to cancel. actionlib would log an
        # error for each of the latter, at each cancel of all goals: a flood of cancels took minutes.
        known = self.status_list
        unfinished = [tracker for tracker in known if tracker.status.status in UNFINISHED]
        is_new = all(tracker.status.goal_id.id != goal_id.id for tracker in known)
        self.status_list = list(unfinished)
        super().internal_cancel_callback(goal_id)
        self.status_list = known + (self.status_list[len(unfinished) :] if is_new else [])

    def _forget_oldest(self) -> None:
        if len(self.status_list) > 2 * ENDED_KEPT:
            older, newest = self.status_list[:-ENDED_KEPT], self.status_list[-ENDED_KEPT:]
            self.status_list = [tracker for tracker in older if tracker.status.status in UNFINISHED] + newest

    def _on_new_goal(self, handle: ServerGoalHandle) -> None:
        self._recall()
        self.waiting = handle

    def _on_cancel(self, handle: ServerGoalHandle) -> None:
        if self.waiting is not None and handle == self.waiting:
            self._recall()
        elif self.current is not None and handle == self.current:
            self.is_cancelled = True

    def _recall(self) -> None:
        if self.waiting is not None:
            self.waiting.set_canceled(NOT_STARTED, NOT_STARTED.message)
        self.waiting = None

    def accept(self) -> GoToPositionGoal:
        """Make the waiting goal, of which there is one, the current one."""
        self.current, self.waiting, self.is_cancelled = self.waiting, None, False
        self.current.set_accepted()
        return cast(GoToPositionGoal, self.current.get_goal())

    def end(self, outcome: Outcome, result: GoToPositionResult) -> None:
        """Give the current goal, if there is one, the terminal state that belongs to its outcome."""
        handle, self.current = self.current, None
        if handle is None:
            return
        set_terminal_state = {
            Outcome.REACHED: handle.set_succeeded,
            Outcome.PREEMPTED: handle.set_canceled,
        }.get(outcome, handle.set_aborted)
        set_terminal_state(result, result.message)
