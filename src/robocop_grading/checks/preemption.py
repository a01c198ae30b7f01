"""Checks of cancelled, replaced and subsequent goals."""

from dataclasses import replace
from typing import Optional

from ..handout import Limits
from ..record import PREEMPTED, RECALLED, SUCCEEDED, Record, SentGoal, status_name
from ..texts import sentences
from .endings import wrong_ending, wrong_success
from .output import EXECUTE_RAISED, logged
from .verdict import PASSED, Failed, Kind, NotReached, Verdict, check

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
    """Why a goal did not end in time: its request was noticed late, or never."""
    results = record.results_of(goal)
    if not results or results[0].status not in (PREEMPTED, RECALLED):
        return f"The {request} is not noticed: {hint}"
    return (
        f"The {request} is noticed only {results[0].time - requested:.1f} s later: {IN_EACH}, while the robot turns "
        "and while it drives, and does nothing else make the callback wait before it ends the goal?"
    )


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
