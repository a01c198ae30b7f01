"""Checks of the reaction to obstacles."""

from dataclasses import replace
from typing import Optional

from ..check_limits import Limits
from ..handout import STOP_DISTANCE
from ..record import ABORTED, STATUS_NAMES, SUCCEEDED, Goal, Record, results_of, samples_between
from .consequences import EXCEPTION
from .endings import EXCEPTION_LOGGED, last_error, logged, narrow_obstacle, wrong_ending
from .verdict import Earlier, Failed, NotReached, Passed, Verdict, check, sentences


@check("distances")
def stops_at_obstacle(record: Record, limits: Limits) -> Verdict:
    """An obstacle closer than 0.3 m ahead aborts the goal before the robot touches it."""
    if not record.goals:
        return NotReached("no goal was sent")
    return _wrong_abort(record, record.goals[0], limits) or Passed()


def _wrong_abort(record: Record, goal: Goal, limits: Limits) -> Optional[Failed]:
    """What went wrong with a goal that should have been aborted at the right distance."""
    problem = wrong_ending(record, goal, ABORTED, limits)
    if problem is not None:
        return problem
    end = results_of(record, goal)[0].time
    around = samples_between(record, end - 0.25, end + limits.stop_within)
    if any(sample.touching for sample in around):
        cause = narrow_obstacle(record) or "The obstacle was detected too late"
        return Failed("a stop before the obstacle", "contact", end, cause)
    wanted = f"an abort at {STOP_DISTANCE:g} m"
    if logged(record, EXCEPTION_LOGGED):
        cause = "The goal's callback raised an exception: " + last_error(record)
        return Failed(wanted, "an exception", end, cause, EXCEPTION)
    clearances = [sample.ahead for sample in samples_between(record, end - 0.25, end)]
    if clearances and min(clearances) > limits.abort_farthest:
        cause = f"The threshold is not {STOP_DISTANCE:g} m, or beams that are not ahead count"
        return Failed(wanted, f"an abort at {min(clearances):.2f} m", end, cause)
    if clearances and clearances[-1] < limits.abort_nearest:
        cause = (
            f"The threshold is not {STOP_DISTANCE:g} m, the scan is evaluated too rarely, or the beams that count are "
            "not those ahead"
        )
        cause = narrow_obstacle(record) or cause
        return Failed(wanted, f"an abort at {clearances[-1]:.2f} m", end, cause)
    return None


@check("distances")
def only_ahead_counts(record: Record, limits: Limits) -> Verdict:
    """Obstacles beside or behind the robot do not abort a goal."""
    for goal in record.goals:
        problem = wrong_ending(record, goal, SUCCEEDED, limits)
        if problem is not None:
            return problem
    return Passed() if record.goals else NotReached("no goal was sent")


@check("distances")
def odd_scans(record: Record, limits: Limits) -> Verdict:
    """Ranges of inf, 0 and NaN are not obstacles, and do not hide obstacles."""
    if not record.goals:
        return NotReached("no goal was sent")
    goal = record.goals[0]
    wanted = STATUS_NAMES.index(goal.ends)
    problem = _wrong_abort(record, goal, limits) if wanted == ABORTED else wrong_ending(record, goal, wanted, limits)
    if problem is None:
        return Passed()
    if wanted == ABORTED:
        problem = replace(problem, follows=(*problem.follows, Earlier("stops_at_obstacle")))
    if problem.follows[:1] == EXCEPTION:
        return problem
    hint = (
        "A range of 0 or NaN is treated as an obstacle" if wanted == SUCCEEDED else "A range of 0 or NaN hides the wall"
    )
    return replace(problem, cause=sentences(problem.cause, f"{hint}: only range_min < r < range_max is a valid range"))
