"""The states of a goal in words."""

from typing import Optional

from actionlib_msgs.msg import GoalStatus

from aro_robocop_goto_as.msg import GoToPositionResult

# Not GoalStatus.to_string: for PENDING, which is 0, it returns the first name whose value equals False.
STATES = {value: name for name, value in vars(GoalStatus).items() if name.isupper() and type(value) is int}
UNFINISHED = ("PENDING", "ACTIVE", "PREEMPTING", "RECALLING")


def ending(state: int, result: Optional[GoToPositionResult]) -> str:
    """How a goal ended: its terminal state, and the result's message, unless this begins with the state itself."""
    message = "" if result is None else result.message
    return message if message.startswith(f"{STATES[state]}:") else ": ".join(filter(None, (STATES[state], message)))
