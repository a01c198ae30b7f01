"""The states of a goal in words."""

from typing import Optional

from actionlib_msgs.msg import GoalStatus

from aro_robocop_goto_as.msg import GoToPositionResult

# Not GoalStatus.to_string: for PENDING, which is 0, it returns the first name whose value equals False.
STATES = {value: name for name, value in vars(GoalStatus).items() if name.isupper() and type(value) is int}
UNFINISHED = ("PENDING", "ACTIVE", "PREEMPTING", "RECALLING")
# What actionlib's server says of a goal that it has dropped is only "RECALLED", without a result's message.
DROPPED = (
    "its server dropped it before it began, as it was cancelled, or as a goal with a later stamp came before: "
    "the server's log says if a stamp is in the future"
)


def ending(state: int, result: Optional[GoToPositionResult]) -> str:
    """How a goal ended: its terminal state, and the result's message, unless this begins with the state itself."""
    message = result_text(state, "" if result is None else result.message)
    return message if message.startswith(f"{STATES[state]}:") else ": ".join(filter(None, (STATES[state], message)))


def result_text(state: int, message: str) -> str:
    """The message of a result; for a goal that was recalled without one, why servers recall goals."""
    return message or (DROPPED if state == GoalStatus.RECALLED else "")
