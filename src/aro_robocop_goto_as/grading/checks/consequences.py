"""Whether a failure follows from that of another check: decided by what the server itself has reported."""

import math
from typing import Tuple

from ..handout import HEADING_TOLERANCE
from ..record import Feedback, Goal, Record
from .verdict import Earlier

EXCEPTION = (Earlier("no_exception"),)
WRONG_ERRORS = (Earlier("feedback_position"), Earlier("feedback_angle"))
MARGIN = 0.03  # [rad] nearer to the handout's threshold both turning and driving are right
ENOUGH = 4  # fewer commands show nothing
MOST_OTHERS = 0.2  # share of commands that may not match, as those at the end of a turn


def silent(record: Record, goal: Goal) -> bool:
    """Whether the server, after it got a goal, neither moved the robot nor published anything about the goal."""
    told = {message.id for message in record.feedback} | {result.id for result in record.results}
    return goal.id not in told and not any(command.time >= goal.time for command in record.commands)


def silenced_by(record: Record, goal: Goal) -> Tuple[Earlier, ...]:
    """The failures that are the reason if nothing came from the server; nothing if something did."""
    if not silent(record, goal):
        return ()
    return (*_death(record), Earlier("reaches_goal", "no result"))


def _death(record: Record) -> Tuple[Earlier, ...]:
    return (Earlier("stays_alive"),) if record.deaths else ()


def stopped_by(record: Record, goal: Goal) -> Tuple[Earlier, ...]:
    """The failures that may be the reason why a goal did not end."""
    if silent(record, goal):
        return silenced_by(record, goal)
    motion = Earlier("turns_to_goal"), Earlier("drives_straight"), Earlier("reaches_goal", "no result")
    return (*_death(record), *misled(record, goal), *motion)


def misled(record: Record, goal: Goal) -> Tuple[Earlier, ...]:
    """The failures of the feedback, if the robot did what its feedback called for."""
    return WRONG_ERRORS if acted_on(record, goal) else ()


def acted_on(record: Record, goal: Goal) -> bool:
    """Whether the robot was commanded as the handout wants for the angle_error that the server reported itself.

    If that angle is wrong, the motion is wrong because of it.
    """
    own = [message for message in record.feedback if message.id == goal.id]
    ends = [result.time for result in record.results if result.id == goal.id]
    fits, number = [], 0
    for command in record.commands:
        if not own or not goal.time <= command.time < min(ends, default=math.inf):
            continue
        while number + 1 < len(own) and own[number + 1].time <= command.time + 1e-6:
            number += 1
        if own[number].time <= command.time + 1e-6:
            fits.append(_fits(own[number], command.v, command.w))
    return len(fits) >= ENOUGH and sum(fits) >= (1.0 - MOST_OTHERS) * len(fits)


def _fits(own: Feedback, v: float, w: float) -> bool:
    turning = abs(v) < 1e-3 and w * own.angle_error > 0.0
    if abs(own.angle_error) > HEADING_TOLERANCE + MARGIN:
        return turning
    return v > 0.0 or (abs(own.angle_error) > HEADING_TOLERANCE - MARGIN and turning)
