"""Whether a failure follows from another check's failure: decided by what happened, and by what the server reported."""

from typing import Mapping, Pattern

from ..handout import GOAL_RADIUS, HEADING_TOLERANCE
from ..record import STATUS_NAMES, SUCCEEDED, Feedback, Goal, Record, active_until, feedback_of, results_of
from .output import EXCEPTION_LOGGED, NO_STATE_LOGGED, last_error, logged
from .verdict import After, Failed

# Kinds of failures.
NO_RESULT = "no result"
SUCCESS = "success"  # too far away from the goal
SUCCESS_LATE = "late success"
LATE = "late"  # a goal that ended too late after a request to end
NOT_RESET = "not reset"  # what an earlier goal has left behind
MOVES_FIRST = "moves first"  # before the errors and the distance are known
TOO_EARLY = "too early"  # an abort too far away from the obstacle

NO_STATE = "execute_cb returned without calling set_succeeded, set_aborted or set_preempted"
MARGIN = 0.03  # [rad] nearer to the handout's threshold both turning and driving are right
ENOUGH = 4  # fewer commands show nothing
MAX_OTHERS = 0.2  # share of commands that may not match, as those at the end of a turn
BELIEVED = 1.2 * GOAL_RADIUS  # [m]
MIN_DELAY = 1.0  # [s] a callback that waits once at the start makes messages wait for less
ITERATION = 0.15  # [s] of a server's loop, with a tick of the recording


def alike(_record: Record, failure: Failed, earlier: Failed) -> bool:
    """Return whether both failures are of the same kind."""
    return bool(failure.kind) and failure.kind == earlier.kind


def logged_cause(record: Record, end: float) -> str:
    """What the log says about why a goal ended wrongly at a time [s]; empty if it says nothing."""
    if logged(record, EXCEPTION_LOGGED, end):
        return f"An exception was raised: {last_error(record, end)}"
    return NO_STATE if logged(record, NO_STATE_LOGGED, end) else ""


def end_of(record: Record, failure: Failed) -> float:
    """The time [s] until which an event can be a failure's reason: when its goal ended, or its own time if later."""
    end = active_until(record, failure.goal) if failure.goal else failure.time
    return max(failure.time, end)


def died(record: Record, failure: Failed, _earlier: Failed) -> bool:
    """Return whether the node died before the goal ended."""
    return any(death.time <= end_of(record, failure) for death in record.deaths)


def raised(record: Record, failure: Failed, _earlier: Failed) -> bool:
    """Return whether an exception was logged before a goal ended otherwise than it should."""
    return bool(failure.kind) and logged(record, EXCEPTION_LOGGED, end_of(record, failure))


def unpublished(records: Mapping[str, Record], name: Pattern[str]) -> str:
    """The first topic with such a name that the node subscribes to and nobody publishes; empty if there is none."""
    topics = [topic for record in records.values() for topic in record.unpublished]
    return next(filter(name.search, topics), "")


def late(records: Mapping[str, Record], name: Pattern[str], what: str) -> str:
    """A sentence: data is old because the callback of a topic with such a name is too slow; empty if no callback is."""
    delays = [(delay, topic) for record in records.values() for topic, delay in record.delays if name.search(topic)]
    delays = [it for it in delays if it[0] >= MIN_DELAY]
    if not delays:
        return ""
    delay, topic = max(delays)
    return (
        f"{what}: messages on {topic} waited up to {delay:.3g} s for their callback, because it takes longer than the "
        "time from one message to the next. It has to store what it needs and return at once, without a sleep or a "
        "long calculation"
    )


def silent(record: Record, goal: Goal) -> bool:
    """Return whether the server, after it got a goal, neither moved the robot nor published anything about the goal."""
    told = [*feedback_of(record, goal), *results_of(record, goal)]
    return not told and not any(command.time >= goal.time for command in record.commands)


def nothing_came(record: Record, failure: Failed, earlier: Failed) -> bool:
    """Return whether nothing came from the server after it got the goal, and the earlier failure says so, too."""
    return failure.goal is not None and silent(record, failure.goal) and earlier.kind == NO_RESULT


def died_before(record: Record, failure: Failed, _earlier: Failed) -> bool:
    """Return whether the node died before anything came from it after it got the goal."""
    return bool(record.deaths) and failure.goal is not None and silent(record, failure.goal)


def working(record: Record, failure: Failed, _earlier: Failed) -> bool:
    """Return whether the server was working on the goal."""
    return failure.goal is not None and not silent(record, failure.goal)


def believed(record: Record, failure: Failed, _earlier: Failed) -> bool:
    """Return whether an end far from the goal fits the position_error that the server reported itself."""
    own = feedback_of(record, failure.goal) if failure.goal else []
    return bool(own) and own[-1].position_error <= BELIEVED


def unaware(record: Record, failure: Failed, _earlier: Failed) -> bool:
    """Return whether the server never reported a position_error that means that the goal is reached."""
    own = feedback_of(record, failure.goal) if failure.goal else []
    end = end_of(record, failure)
    return not any(it.position_error < GOAL_RADIUS and it.time < end - ITERATION for it in own)


def misled(record: Record, failure: Failed, _earlier: Failed) -> bool:
    """Return whether the commands are right for the angle_error that the server itself reported.

    If that angle is wrong, the motion is wrong because of it.
    """
    goal = failure.goal
    if goal is None or failure.kind == SUCCESS:
        return False
    own = feedback_of(record, goal)
    end = active_until(record, goal)
    fits, number = [], 0
    for command in record.commands:
        if not own or not goal.time <= command.time < end:
            continue
        while number + 1 < len(own) and own[number + 1].time <= command.time + 1e-6:
            number += 1
        if own[number].time <= command.time + 1e-6:
            fits.append(_fits(own[number], command.v, command.w))
    return len(fits) >= ENOUGH and sum(fits) >= (1.0 - MAX_OTHERS) * len(fits)


def _fits(own: Feedback, v: float, w: float) -> bool:
    turning = abs(v) < 1e-3 and w * own.angle_error > 0.0
    if abs(own.angle_error) > HEADING_TOLERANCE + MARGIN:
        return turning
    return v > 0.0 or (abs(own.angle_error) > HEADING_TOLERANCE - MARGIN and turning)


EXCEPTION = After("no_exception", raised)
AT_FIRST = After("already_there", kind=MOVES_FIRST)
MISLED = After("feedback_angle", misled)
# What every goal's ending depends on.
ENDING = (
    EXCEPTION,
    After("stays_alive", died, NO_RESULT),
    After("feedback_rate", unaware, SUCCESS_LATE),
    After("feedback_position", believed, SUCCESS),
    After("feedback_position", believed, STATUS_NAMES[SUCCEEDED]),
    After("feedback_position", misled, NO_RESULT),
    After("feedback_position", misled, SUCCESS_LATE),
    MISLED,
    After("turns_to_goal", working, NO_RESULT),
    After("drives_straight", working, NO_RESULT),
    After("reaches_goal", alike),
)
