"""Checks of cancelled, replaced and subsequent goals."""

from dataclasses import replace
from typing import Optional

from ..handout import Limits
from ..record import PREEMPTED, RECALLED, SUCCEEDED, Record, SentGoal, status_name
from ..texts import sentences
from .endings import wrong_ending, wrong_success
from .output import EXECUTE_RAISED, logged
from .verdict import PASSED, Failed, Kind, NotReached, Verdict, check

MOVING, TURNING = 0.02, 0.05  # [m/s], [rad/s]
MOSTLY = 0.7
ENDS = 0.3  # [s] in which the robot stops
SILENT = 1.0  # [s] after which feedback, if it goes on, has come
IN_EACH = "is is_preempt_requested() called in each iteration"


@check("server", "cancel cancel_turning", plot="states")
def cancel(record: Record, limits: Limits) -> Verdict:
    """A cancelled goal ends as PREEMPTED without delay, and without success."""
    if not record.cancels:
        return NotReached("the goal ended before it could be cancelled")
    request = record.cancels[0]
    goal = next(goal for goal in record.goals if goal.id == request.id)
    hint = f"{IN_EACH}?"
    return _preempted(record, goal, request.time, limits, "cancel request", hint) or PASSED


@check("server", "newer_goal", plot="states")
def newer_goal(record: Record, limits: Limits) -> Verdict:
    """A newer goal preempts the older one and is reached."""
    if len(record.goals) < 2:
        return NotReached("the first goal ended before a newer one could be sent")
    older, newer = record.goals[:2]
    hint = "is_preempt_requested() is true for a newer goal as well, and the loop has to end then"
    problem = _preempted(record, older, newer.time, limits, "newer goal", hint)
    return problem or wrong_ending(record, newer, SUCCEEDED, limits) or PASSED


def _preempted(
    record: Record, goal: SentGoal, requested: float, limits: Limits, request: str, hint: str
) -> Optional[Failed]:
    results = record.results_of(goal)
    if not results or results[0].time > requested + limits.preempt_within:
        seen = f"a result {results[0].time - requested:.1f} s later" if results else "no result"
        wanted = f"PREEMPTED within {limits.preempt_within:g} s of the {request}"
        return Failed(wanted, seen, requested, _unnoticed(record, goal, requested, request, hint), Kind.END_LATE, goal)
    if results[0].status in (PREEMPTED, RECALLED):
        if results[0].success:
            cause = "result.success is true although the goal was not reached"
            return Failed("success False", "success True", results[0].time, cause)
        return None
    return wrong_ending(record, goal, PREEMPTED, limits)


def _unnoticed(record: Record, goal: SentGoal, requested: float, request: str, hint: str) -> str:
    """Why a goal did not end in time: its request was noticed late, only while the robot drove, or never."""
    results = record.results_of(goal)
    if not results or results[0].status not in (PREEMPTED, RECALLED):
        times = [feedback.time for feedback in record.feedback_of(goal)]
        if times and not results and times[-1] < requested + SILENT:
            return f"After the {request} neither feedback nor a result of the goal comes"
        return f"The {request} is not noticed: {hint}"
    own = record.feedback_of(goal)
    if own and own[-1].time < requested + SILENT and _begins_other(record, goal, requested, results[0].time):
        return (
            f"The {request} is noticed at once, but the older goal's result comes "
            f"{results[0].time - requested:.1f} s later: set its terminal state as soon as it no longer runs"
        )
    late = f"The {request} is noticed only {results[0].time - requested:.1f} s later"
    waiting = record.samples_between(requested, results[0].time - ENDS)
    turning = sum(abs(sample.w) > TURNING and abs(sample.v) < MOVING for sample in waiting)
    driving = sum(abs(sample.v) >= MOVING for sample in waiting)
    if turning > MOSTLY * len(waiting):
        return f"{late}, when the robot has turned: {IN_EACH}, also while it turns?"
    if driving > MOSTLY * len(waiting):
        return f"{late}, and the robot drives on until then: {IN_EACH}, also while it drives?"
    return f"{late}: {IN_EACH}, and does nothing else make the callback wait before it ends the goal?"


def _begins_other(record: Record, goal: SentGoal, requested: float, end: float) -> bool:
    """Return whether, soon after a request [s], the robot stands still or the server tells of another goal."""
    others = [it for it in record.feedback if it.id != goal.id and requested < it.time < requested + SILENT]
    waiting = record.samples_between(requested + SILENT, end - ENDS)
    stands = all(abs(it.v) < MOVING and abs(it.w) < TURNING for it in waiting)
    return bool(others) or (bool(waiting) and stands)


@check("server", "behind obstacle cancel newer_goal", plot="states")
def next_goal(record: Record, limits: Limits) -> Verdict:
    """After a goal has ended, in any state, the next one is served."""
    if len(record.goals) < 2 or not record.results_of(record.goals[-2]):
        return NotReached("the first goal did not end")
    goal = record.goals[-1]
    answered = {status.id for status in record.statuses} | {result.id for result in record.results}
    if goal.id not in answered:
        cause = "The server no longer accepts goals"
        return Failed("an answer to the next goal", "none", goal.time, cause, Kind.NO_ANSWER, goal)
    problem = wrong_success(record, goal, limits)
    if problem is None:
        return PASSED
    if logged(record, EXECUTE_RAISED, problem.time, goal.time) or problem.kind is Kind.NOT_RESET:
        return problem
    before = status_name(record.results_of(record.goals[-2])[0].status)
    hint = f"The next goal fails after the one before it ended as {before}: is all state that a goal changes reset?"
    return replace(problem, cause=sentences(problem.cause, hint))
