"""The goals that a bridge has sent, published as an action server would; callers decide what becomes of the goals."""

from typing import Any, Callable, Container, Dict, List, Optional

import rospy
from actionlib_msgs.msg import GoalID, GoalStatus, GoalStatusArray
from aro_robocop_goto_as.msg import (
    GoToPositionActionFeedback,
    GoToPositionActionGoal,
    GoToPositionActionResult,
    GoToPositionFeedback,
    GoToPositionResult,
)

from ..handout import ACTION

KEPT = rospy.Duration(5.0)  # for which actionlib's server goes on to tell of a goal that has ended
ACCEPTED = "This goal has been accepted by the simple action server"  # actionlib's text
REQUESTED = {GoalStatus.PENDING: GoalStatus.RECALLING, GoalStatus.ACTIVE: GoalStatus.PREEMPTING}
CANCELLED = {GoalStatus.RECALLING: GoalStatus.RECALLED, GoalStatus.PREEMPTING: GoalStatus.PREEMPTED}


class Goals:
    """Their states, and what is published of them: status, feedback, result."""

    def __init__(self, publish: Callable[[str, Any], object], stamp: Callable[[], rospy.Time]) -> None:
        self._publish, self._stamp = publish, stamp
        self._statuses: Dict[str, GoalStatus] = {}
        self._ended: Dict[str, rospy.Time] = {}
        self._last_cancel = rospy.Time()
        self._made = 0  # ids
        self.publish_status()

    def publish_status(self) -> None:
        """Publish the states of all goals."""
        now = self._stamp()
        for name, ended in list(self._ended.items()):
            if ended + KEPT < now:
                del self._ended[name], self._statuses[name]
        array = GoalStatusArray(status_list=list(self._statuses.values()))
        array.header.stamp = now
        self._publish(f"{ACTION}/status", array)

    def identified(self, goal_id: GoalID) -> GoalID:
        """A goal's id; missing parts are completed as actionlib's server does."""
        self._made += not goal_id.id
        return GoalID(goal_id.stamp or self._stamp(), goal_id.id or f"{ACTION}-{self._made}")

    def add(self, goal: GoToPositionActionGoal) -> Optional[int]:
        """Add a goal that has come; return its state: PENDING, RECALLED if it was cancelled before, None if known."""
        name, stamp = goal.goal_id.id, goal.goal_id.stamp
        known = self._statuses.get(name)
        if known is not None and known.status != GoalStatus.RECALLING:
            return None
        self._statuses[name] = GoalStatus(goal.goal_id, GoalStatus.PENDING, "")
        if known is None and not (stamp and stamp <= self._last_cancel):
            return int(GoalStatus.PENDING)
        return self.cancel(name, GoToPositionResult())

    def running(self) -> List[str]:
        """The ids of the goals that have not ended."""
        return [name for name in self._statuses if name not in self._ended]

    def accept(self, name: str) -> None:
        """Make a goal ACTIVE."""
        self._statuses[name].status, self._statuses[name].text = GoalStatus.ACTIVE, ACCEPTED
        self.publish_status()
        feedback = GoToPositionActionFeedback(
            status=self._statuses[name], feedback=GoToPositionFeedback(1.0, 0.0, "on the way")
        )
        feedback.header.stamp = self._stamp()
        self._publish(f"{ACTION}/feedback", feedback)

    def request_cancel(self, request: GoalID, spared: Container[str] = ()) -> List[str]:
        """Note a cancel request, also for a goal of its id that is still to come; return its goals that have not ended.

        spared: goals that a request for all goals is not for
        """
        everything, names = not request.id and not request.stamp, []
        for name, status in list(self._statuses.items()):
            before = bool(request.stamp) and status.goal_id.stamp <= request.stamp
            is_for = request.id == name or before or (everything and name not in spared)
            if is_for and status.status in REQUESTED:
                names.append(name)
                status.status = REQUESTED[status.status]
                self.publish_status()
        if request.id and request.id not in self._statuses:
            self._statuses[request.id] = GoalStatus(request, GoalStatus.RECALLING, "")
            self._ended[request.id] = self._stamp()
        self._last_cancel = max(self._last_cancel, request.stamp)
        return names

    def cancel(self, name: str, result: GoToPositionResult) -> int:
        """End a goal as cancelled; return its state: RECALLED if it was not accepted, else PREEMPTED."""
        status = self._statuses[name].status
        state = CANCELLED[REQUESTED.get(status, status)]
        self._end(name, state, result)
        return int(state)

    def finish(self, name: str, status: int) -> None:
        """End a goal as SUCCEEDED, ABORTED, or PREEMPTED as if somebody else had cancelled it."""
        succeeded = status == GoalStatus.SUCCEEDED
        self._end(name, status, GoToPositionResult(succeeded, "there" if succeeded else "not there"))

    def _end(self, name: str, status: int, result: GoToPositionResult) -> None:
        self._statuses[name].status, self._statuses[name].text = status, ""
        self._ended[name] = self._stamp()
        message = GoToPositionActionResult(status=self._statuses[name], result=result)
        message.header.stamp = self._stamp()
        self._publish(f"{ACTION}/result", message)
        self.publish_status()
