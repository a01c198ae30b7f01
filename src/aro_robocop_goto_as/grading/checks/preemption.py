"""Checks of cancelled, replaced and subsequent goals."""

from dataclasses import replace

from ..check_limits import Limits
from ..record import PREEMPTED, RECALLED, SUCCEEDED, Goal, Record, results_of, status_name
from .consequences import EXCEPTION, silenced_by
from .endings import EXCEPTION_LOGGED, logged, success_too_far, wrong_ending
from .verdict import Earlier, Failed, NotReached, Passed, Verdict, check, sentences


@check("states")
def cancel(record: Record, limits: Limits) -> Verdict:
    """A cancelled goal ends as PREEMPTED without delay, and without success."""
    if not record.cancels:
        return NotReached("the goal ended before it could be cancelled")
    request = record.cancels[0]
    goal = next(goal for goal in record.goals if goal.id == request.id)
    hint = "is is_preempt_requested() called in each iteration?"
    return _preempted(record, goal, request.time, limits, "cancel request", hint)


@check("states")
def newer_goal(record: Record, limits: Limits) -> Verdict:
    """A newer goal preempts the older one and is reached."""
    if len(record.goals) < 2:
        return NotReached("the first goal ended before a newer one could be sent")
    older, newer = record.goals[:2]
    hint = "is_preempt_requested() is true for a newer goal as well, and the loop has to end then"
    verdict = _preempted(record, older, newer.time, limits, "newer goal", hint)
    if not isinstance(verdict, Passed):
        return verdict
    return wrong_ending(record, newer, SUCCEEDED, limits) or Passed()


def _preempted(record: Record, goal: Goal, requested: float, limits: Limits, request: str, hint: str) -> Verdict:
    results = results_of(record, goal)
    if not results or results[0].time > requested + limits.preempt_within:
        seen = f"a result {results[0].time - requested:.1f} s later" if results else "no result"
        wanted = f"PREEMPTED within {limits.preempt_within:g} s of the {request}"
        follows = silenced_by(record, goal) or (Earlier("cancel"),)
        if logged(record, EXCEPTION_LOGGED):
            follows = EXCEPTION
        return Failed(wanted, seen, requested, f"The {request} is not noticed: {hint}", follows)
    if results[0].status in (PREEMPTED, RECALLED):
        if results[0].success:
            cause = "result.success is true although the goal was not reached"
            return Failed("success False", "success True", results[0].time, cause)
        return Passed()
    return wrong_ending(record, goal, PREEMPTED, limits) or Passed()


@check("states")
def next_goal(record: Record, limits: Limits) -> Verdict:
    """After a goal has ended, in any state, the next one is served."""
    if len(record.goals) < 2 or not results_of(record, record.goals[0]):
        return NotReached("the first goal did not end")
    goal = record.goals[-1]
    answered = {status.id for status in record.statuses} | {result.id for result in record.results}
    if goal.id not in answered:
        cause = "The server no longer accepts goals"
        return Failed("an answer to the second goal", "none", goal.time, cause, (Earlier("stays_alive"), *EXCEPTION))
    problem = wrong_ending(record, goal, SUCCEEDED, limits) or success_too_far(record, goal, limits)
    if problem is None:
        return Passed()
    problem = replace(problem, follows=(*problem.follows, Earlier("reaches_goal")))
    if problem.follows[:1] == EXCEPTION:
        return problem
    first = status_name(results_of(record, record.goals[0])[0].status)
    cause = (
        f"The second goal fails after the first one ended as {first}: is all state that the first goal changed reset?"
    )
    return replace(problem, cause=sentences(problem.cause, cause))
