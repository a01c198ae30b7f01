"""actionlib's SimpleActionServer, mended where it would leave a client without words or refuse every goal."""

from typing import Any, Callable

import actionlib
import rospy

from aro_robocop_goto_as.msg import GoToPositionAction, GoToPositionGoal, GoToPositionResult

from .timer import start_timer


class GoalServer(actionlib.SimpleActionServer):
    """A SimpleActionServer of GoToPosition goals."""

    def __init__(self, name: str, execute: Callable[[GoToPositionGoal], None],
                 bumped_result: Callable[[], GoToPositionResult]) -> None:
        super().__init__(name, GoToPositionAction, execute, auto_start=False)
        # What it ends by itself, a goal bumped before it began, gets this result instead of an empty one.
        inner = self.action_server
        inner.ActionResultType = bumped_result
        take = inner.internal_goal_callback

        def take_unless_cancelled(goal: Any) -> None:
            """A cancel stamped in the future would recall every goal until then: it counts for those up to now."""
            with inner.lock:
                if inner.last_cancel > rospy.get_rostime():
                    inner.last_cancel = rospy.Time()
            take(goal)

        inner.internal_goal_callback = take_unless_cancelled  # what start() subscribes with

    def start(self) -> None:
        """Begin to take goals."""
        super().start()
        inner = self.action_server
        # actionlib's own timer ends for good when the clock is set back.
        if inner.status_timer is not None:
            inner.status_timer.shutdown()
            inner.status_timer = start_timer(1.0 / inner.status_frequency, lambda: inner.publish_status_async(None))

    def internal_goal_callback(self, goal: Any) -> None:
        """Take a goal: the one that arrives last counts, whatever its stamp.

        SimpleActionServer refuses goals stamped earlier than the newest it has seen, so after a simulator set the
        clock back it would refuse every one. Arrival says as much: a client's messages come in order.
        """
        with self.action_server.lock, self.lock:
            stamp = goal.get_goal_id().stamp
            for handle in (self.current_goal, self.next_goal):
                if handle.get_goal() and handle.get_goal_id().stamp > stamp:
                    handle.get_goal_id().stamp = stamp
        super().internal_goal_callback(goal)
