"""What becomes of a goal, as actionlib's client knows it; the go-to server's clients share it."""

import logging
from typing import Callable

import actionlib
import rospy
from actionlib_msgs.msg import GoalStatus
from geometry_msgs.msg import Point

from aro_robocop_goto_as.msg import GoToPositionAction, GoToPositionFeedback, GoToPositionGoal

from ..waiting import wait_until

# Not GoalStatus.to_string: for PENDING, which is 0, it returns the first name whose value equals False.
STATES = {value: name for name, value in vars(GoalStatus).items() if name.isupper() and type(value) is int}
UNFINISHED = ("PENDING", "ACTIVE", "PREEMPTING", "RECALLING")
# actionlib's error if a goal starts before send_goal() has returned, which does no harm here.
UNLOGGED = "Got a transition callback on a goal handle"


def ending(state: int, message: str, text: str) -> str:
    """How a goal ended: its terminal state, and the result's message, or without one actionlib's own text."""
    words = message or text
    return words if words.startswith(f"{STATES[state]}:") else ": ".join(filter(None, (STATES[state], words)))


class GoalFollower:
    """Sends goals by SimpleActionClient, and follows the newest one to its end."""

    def __init__(self, action: str, on_feedback: Callable[[GoToPositionFeedback], None]) -> None:
        logging.getLogger("rosout").addFilter(lambda record: not record.getMessage().startswith(UNLOGGED))
        self.client = actionlib.SimpleActionClient(action, GoToPositionAction)
        self._on_feedback = on_feedback

    def is_up(self) -> bool:
        """Return whether the client is connected to its server, without waiting; False while ROS time is still zero.

        The timeout is over at once, also while the simulator is paused and ROS time would never reach a later time.
        """
        return bool(rospy.get_rostime()) and self.client.wait_for_server(rospy.Duration(nsecs=-1))

    def send(self, position: Point) -> None:
        """Send a goal, which is followed from now on instead of the one before."""
        self.client.send_goal(GoToPositionGoal(position), feedback_cb=self._on_feedback)

    def cancel(self, timeout: float) -> bool:
        """Cancel the goal, and wait for its end up to a timeout [s, wall]; whether it has ended."""
        self.client.cancel_goal()
        return wait_until(self.has_ended, timeout)

    def has_ended(self) -> bool:
        """Return whether no goal runs; not by a callback, which misses an end before send_goal() has returned."""
        return self.client.gh is None or bool(self.client.gh.get_comm_state() == actionlib.CommState.DONE)

    def state(self) -> str:
        """The goal's state in actionlib's words; of one that has ended, with what its server says of the end."""
        has_ended, state, result = self.has_ended(), self.client.get_state(), self.client.get_result()
        if not has_ended:
            return STATES[state]
        return ending(state, "" if result is None else result.message, self.client.get_goal_status_text())

    def is_reached(self) -> bool:
        """Return whether the goal has ended with success."""
        result = self.client.get_result()
        return result is not None and bool(result.success)
