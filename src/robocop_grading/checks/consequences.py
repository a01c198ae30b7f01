"""What follows from what: one table, whose conditions look at what happened and at what the server reported."""

from bisect import bisect_right
from typing import Callable, NamedTuple, Optional, Sequence, TypeVar

from ..handout import GOAL_RADIUS, HEADING_TOLERANCE
from ..record import Command, Feedback, Record, Sample, SentGoal
from .endings import at_once
from .output import NO_STATE_LOGGED, UNCAUGHT, logged
from .verdict import Failed, Kind

T = TypeVar("T", Feedback, Sample)
MARGIN = 0.03  # [rad] nearer to the handout's threshold both turning and driving are right
ENOUGH = 4  # fewer commands show nothing
MAX_OTHERS = 0.2  # share of commands that may not match, as those at the end of a turn
NEAR_GOAL = 1.2 * GOAL_RADIUS  # [m]
SLOW = 4.0  # [Hz] of commands, at which a server reacts late
ITERATION = 0.15  # [s] of a server's loop, with a tick of the recording


def same_kind(_record: Record, failure: Failed, earlier: Failed) -> bool:
    """Return whether both failures are of the same kind."""
    return failure.kind is not None and failure.kind is earlier.kind


def end_of(record: Record, failure: Failed) -> float:
    """The time [s] until which an event can be a failure's reason: when its goal ended, or its own time if later."""
    end = record.active_until(failure.goal) if failure.goal else failure.time
    return max(failure.time, end)


def starting(record: Record, _failure: Failed, _earlier: Failed) -> bool:
    """Return whether the node failed when it started, so that no action server came up."""
    return record.name == "start" and not record.up


def not_killed(record: Record, _failure: Failed, _earlier: Failed) -> bool:
    """Return whether nothing other than an exception ended the node."""
    return not any(end.reason or end.is_unexplained for end in record.node_ends)


def died(record: Record, failure: Failed, _earlier: Failed) -> bool:
    """Return whether the node died before the goal ended."""
    return any(end.time <= end_of(record, failure) for end in record.node_ends)


def raised(record: Record, failure: Failed, _earlier: Failed) -> bool:
    """Return whether an exception was logged before a goal ended otherwise than it should."""
    end = failure.time if failure.kind is Kind.MOVES_FIRST else end_of(record, failure)
    return failure.kind not in (None, Kind.TOO_NEAR) and logged(record, UNCAUGHT, end)


def no_state_set(record: Record, failure: Failed, _earlier: Failed) -> bool:
    """Return whether actionlib had to set a goal's terminal state."""
    return logged(record, NO_STATE_LOGGED, failure.time)


def not_accepted(_record: Record, _failure: Failed, earlier: Failed) -> bool:
    """Return whether actionlib refused the states of goals that the server had not accepted."""
    return earlier.kind is Kind.NOT_ACCEPTED


def silent(record: Record, goal: SentGoal) -> bool:
    """Return whether the server, after it got a goal, neither moved the robot nor published anything about the goal."""
    told = [*record.feedback_of(goal), *record.results_of(goal)]
    return not told and not any(command.time >= goal.time for command in record.commands)


def nothing_published(record: Record, failure: Failed, earlier: Failed) -> bool:
    """Return whether nothing came from the server after it got the goal, and the earlier failure says so, too."""
    return failure.goal is not None and silent(record, failure.goal) and earlier.kind is Kind.NO_RESULT


def came_near(record: Record, failure: Failed) -> bool:
    """Return whether the robot came to the goal before the failure."""
    goal = failure.goal
    there = record.samples_between(goal.time, failure.time) if goal else []
    return goal is not None and any(goal.errors_at(it)[0] < NEAR_GOAL for it in there)


def never_came_near(record: Record, failure: Failed, _earlier: Failed) -> bool:
    """Return whether the server was working on the goal, and the robot never came to it."""
    return failure.goal is not None and not silent(record, failure.goal) and not came_near(record, failure)


def reported_near(record: Record, failure: Failed, _earlier: Failed) -> bool:
    """Return whether an end far from the goal fits the position_error that the server reported itself."""
    reports = record.feedback_of(failure.goal) if failure.goal else []
    return bool(reports) and reports[-1].position_error <= NEAR_GOAL


def slow_loop(record: Record, _failure: Failed, earlier: Failed) -> bool:
    """Return whether feedback comes too seldom, and commands come as seldom."""
    latest = record.samples[-1].time if record.samples else 0.0
    spans = [(goal.time, min(record.active_until(goal), latest)) for goal in record.goals]
    commands = sum(begin <= it.time < end for begin, end in spans for it in record.commands)
    reports = sum(begin <= it.time < end for begin, end in spans for it in record.feedback)
    few = SLOW * sum(end - begin for begin, end in spans)
    return earlier.kind is Kind.TOO_LITTLE and 0 < commands < min(few, 1.5 * reports + ENOUGH)


def never_reported_near(record: Record, failure: Failed, _earlier: Failed) -> bool:
    """Return whether the server never reported a position_error that means that the goal is reached."""
    reports = record.feedback_of(failure.goal) if failure.goal else []
    end = end_of(record, failure)
    return not any(it.position_error < GOAL_RADIUS and it.time < end - ITERATION for it in reports)


def misled(record: Record, failure: Failed, _earlier: Failed) -> bool:
    """Return whether the commands that are wrong for the true angle_error are right for the one that was reported."""
    goal = failure.goal
    if goal is None or failure.kind is Kind.TOO_FAR:
        return False
    latest_report, latest_sample = _latest(record.feedback_of(goal)), _latest(record.samples)
    fits = []
    for command in record.commands:
        if goal.time <= command.time < record.active_until(goal):
            report, sample = latest_report(command.time), latest_sample(command.time)
            if report and sample and not _fits(goal.errors_at(sample)[1], command):
                fits.append(_fits(report.angle_error, command))
    return len(fits) >= ENOUGH and sum(fits) >= (1.0 - MAX_OTHERS) * len(fits)


def _latest(timed: Sequence[T]) -> Callable[[float], Optional[T]]:
    """The last one of some messages or samples that is not later than a time [s]."""
    times = [it.time for it in timed]

    def latest(time: float) -> Optional[T]:
        number = bisect_right(times, time + 1e-6)
        return timed[number - 1] if number else None

    return latest


def _fits(angle_error: float, command: Command) -> bool:
    """Return whether a command is right for an angle_error [rad]."""
    turning = abs(command.v) < 1e-3 and command.w * angle_error > 0.0
    if abs(angle_error) > HEADING_TOLERANCE + MARGIN:
        return turning
    return command.v > 0.0 or (abs(angle_error) > HEADING_TOLERANCE - MARGIN and turning)


def too_early_elsewhere(_record: Record, _failure: Failed, earlier: Failed) -> bool:
    """Return whether the server also aborts too far away from an obstacle ahead."""
    return earlier.kind is Kind.TOO_EARLY


def at_wall(_record: Record, failure: Failed, _earlier: Failed) -> bool:
    """Return whether the goal had to be aborted."""
    return failure.goal is not None and failure.goal.ends == "ABORTED"


def of_a_goal_that_ended_at_once(record: Record, failure: Failed, earlier: Failed) -> bool:
    """Return whether the wrong feedback is about a goal that began with what an earlier one had set."""
    return earlier.kind is Kind.NOT_RESET and failure.goal is not None and at_once(record, failure.goal)


class Row(NamedTuple):
    """A failure of the later check that is of this kind follows from the earlier check's failure, if `when` holds."""

    later: str  # names of checks; empty: every check
    kind: Optional[Kind]  # None: any kind, of a scenario that was recorded
    earlier: str  # name of a check
    when: Optional[Callable[[Record, Failed, Failed], bool]] = None  # the later check's record, and both failures


GOAL_CHECKS = (
    "reaches_goal goal_behind far_goal already_there stops_at_obstacle only_ahead_counts odd_scans cancel newer_goal "
    "next_goal"
)
BRIDGE_CHECKS = "forwards_goal reports_status cancels_older waits_for_server goal_frame"

# A failure, or a check that is not reached, follows from the first row that applies to it.
FOLLOWS = (
    # The node does not start, raises an exception, or dies.
    Row("no_exception stays_alive", None, "action_server", starting),
    Row("stays_alive", None, "no_exception", not_killed),
    # Feedback.
    Row("feedback_rate", Kind.TOO_LITTLE, "no_exception", raised),
    Row("feedback_position feedback_angle", None, "next_goal", of_a_goal_that_ended_at_once),
    # How goals end.
    Row("only_ahead_counts", Kind.ABORTED, "stops_at_obstacle", too_early_elsewhere),
    Row(
        f"{GOAL_CHECKS} turns_to_goal success_result failure_result stands_at_end one_ending",
        None,
        "no_exception",
        raised,
    ),
    Row("success_result failure_result", Kind.NO_MESSAGE, "one_ending", no_state_set),
    Row(f"{GOAL_CHECKS} feedback_rate", None, "stays_alive", died),
    Row(GOAL_CHECKS, None, "one_ending", not_accepted),
    Row(GOAL_CHECKS, Kind.SUCCESS_LATE, "feedback_rate", never_reported_near),
    Row(GOAL_CHECKS, Kind.TOO_FAR, "feedback_position", reported_near),
    Row(f"{GOAL_CHECKS} turns_to_goal drives_straight", None, "feedback_angle", misled),
    Row(GOAL_CHECKS, Kind.NO_RESULT, "turns_to_goal", never_came_near),
    Row(GOAL_CHECKS, Kind.NO_RESULT, "drives_straight", never_came_near),
    Row(GOAL_CHECKS, None, "reaches_goal", same_kind),
    Row("feedback_rate cancel newer_goal", None, "reaches_goal", nothing_published),
    Row("turns_to_goal", Kind.MOVES_FIRST, "already_there", same_kind),
    Row("stops_at_obstacle", Kind.MOVES_FIRST, "turns_to_goal", same_kind),
    Row("odd_scans", None, "stops_at_obstacle", at_wall),
    Row("stops_at_obstacle odd_scans", Kind.MOVING, "stands_at_end"),
    Row("goal_behind", Kind.LONG_TURN, "feedback_rate", slow_loop),
    Row("stops_at_obstacle odd_scans", Kind.TOO_NEAR, "feedback_rate", slow_loop),
    Row("goal_behind", Kind.LONG_TURN, "drives_straight"),
    Row("goal_behind", Kind.LONG_TURN, "turns_to_goal"),
    Row("newer_goal", None, "cancel", same_kind),
    Row("goal_behind newer_goal", None, "next_goal", same_kind),
    # The bridge.
    Row(BRIDGE_CHECKS, Kind.NO_GOAL, "bridge_alive"),
    Row(BRIDGE_CHECKS, Kind.NO_REPORT, "bridge_alive"),
    Row("cancels_older waits_for_server goal_frame", None, "forwards_goal", same_kind),
    # What a check needs to be reached.
    Row("feedback_position feedback_angle", Kind.NOT_REACHED, "feedback_rate"),
    Row("failure_result", Kind.NOT_REACHED, "stops_at_obstacle"),
    Row(
        "turns_to_goal drives_straight success_result goal_behind far_goal already_there only_ahead_counts cancel "
        "newer_goal next_goal stands_at_end one_ending",
        Kind.NOT_REACHED,
        "reaches_goal",
    ),
    Row(GOAL_CHECKS, Kind.NOT_REACHED, "stays_alive"),
    Row(BRIDGE_CHECKS, Kind.NOT_REACHED, "bridge_alive"),
    Row(BRIDGE_CHECKS, Kind.NOT_REACHED, "forwards_goal"),
    Row("", Kind.NOT_REACHED, "action_server"),  # the last one: a server of another name is judged as well
)
