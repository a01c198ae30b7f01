"""Checks of the reaction to obstacles."""

import math
import re
from dataclasses import replace
from typing import Mapping, Optional, Sequence

from ..handout import HEADING_TOLERANCE, STOP_DISTANCE, Limits
from ..record import ABORTED, AT_END, STATUS_NAMES, Record, SentGoal
from ..texts import sentences
from .endings import keeps_moving, narrow_obstacle, of_goals, wrong_ending, wrong_success
from .output import EXECUTE_RAISED, logged, logged_cause
from .topic_use import late, unpublished
from .verdict import PASSED, Failed, Kind, NotReached, Verdict, check

SCAN_TOPIC = re.compile("scan|laser|lidar")  # in its name
DISTANCE_NOISE = 0.03  # [m] of noise, and of a first command before the distance is known
FAR_BEYOND = 0.1  # [m] beyond the limit: no threshold that is a little too large explains that
ABORTED_FAR = (
    f"The goal was aborted farther than {STOP_DISTANCE:g} m from the obstacle: is the threshold wrong, do beams "
    "count that are not ahead, or does something else abort the goal?"
)
ABORTED_NEAR = (
    f"The goal was aborted nearer than {STOP_DISTANCE:g} m to the obstacle: is the threshold wrong, is the "
    "newest scan used in each iteration, and are the beams that count those ahead?"
)


def _explained(records: Mapping[str, Record], _names: Sequence[str], failure: Failed) -> Failed:
    """The failure to notice an obstacle with its cause if no scan can come, or comes late."""
    silent = unpublished(records, SCAN_TOPIC)
    unnoticed = failure.kind in (Kind.SUCCEEDED, Kind.TOO_FAR, Kind.NO_RESULT, Kind.MOVES_FIRST)
    if silent and unnoticed:
        cause = f"The node subscribes to {silent}, which nobody publishes; the laser's topic is /scan"
        return replace(failure, cause=cause)
    of_old_scan = late(records, SCAN_TOPIC, "The distance ahead is that of an old scan")
    return (
        replace(failure, cause=of_old_scan)
        if of_old_scan and (unnoticed or failure.kind in (None, Kind.TOO_NEAR))
        else failure
    )


@check("server", "obstacle near_wall pillar_left pillar_right", plot="distances", explain=_explained)
def stops_at_obstacle(record: Record, limits: Limits) -> Verdict:
    """An obstacle closer than 0.3 m ahead aborts the goal before the robot touches it."""
    if not record.goals:
        return NotReached("no goal was sent")
    return _wrong_abort(record, record.goals[0], limits) or PASSED


def _wrong_abort(record: Record, goal: SentGoal, limits: Limits) -> Optional[Failed]:
    """What went wrong with a goal that should have been aborted at the right distance."""
    problem = _approach(record, goal) or wrong_ending(record, goal, ABORTED, limits)
    if problem is not None:
        return problem
    end = record.results_of(goal)[0].time
    around = record.samples_between(end - AT_END, end + limits.stop_within)
    contact = next((sample.time for sample in around if sample.touching), math.inf)
    if contact <= end:
        cause = narrow_obstacle(record) or "The obstacle was detected too late"
        return Failed("a stop before the obstacle", "contact", end, cause)
    wanted = f"an abort at {STOP_DISTANCE:g} m"
    if logged(record, EXECUTE_RAISED, end, goal.time):
        return Failed(wanted, "an exception", end, logged_cause(record, end), Kind.EXCEPTION, goal)
    clearances = [sample.ahead for sample in record.samples_between(end - AT_END, end)]
    if clearances and min(clearances) > limits.abort_farthest:
        return Failed(wanted, f"an abort at {min(clearances):.2f} m", end, ABORTED_FAR, Kind.TOO_EARLY, goal)
    if clearances and clearances[-1] < limits.abort_nearest:
        cause = narrow_obstacle(record) or _late_cause(record, goal, end, clearances[-1])
        return Failed(wanted, f"an abort at {clearances[-1]:.2f} m", end, cause, Kind.TOO_NEAR)
    if contact < math.inf:
        cause = keeps_moving(record, record.results_of(goal)[0], contact)
        return Failed("a stop before the obstacle", "contact", contact, cause, Kind.MOVING, goal)
    return None


def _late_cause(record: Record, goal: SentGoal, end: float, clearance: float) -> str:
    """Why a goal was aborted at a time [s], when the obstacle was nearer [m] than it should have been."""
    own = [it for it in record.feedback_of(goal) if it.time <= end]
    there = record.samples_between(goal.time, end)
    angles = [own[-1].angle_error, goal.errors_at(there[-1])[1]] if own and there else [0.0]
    if all(abs(angle) > HEADING_TOLERANCE for angle in angles):  # it was about to turn
        return (
            f"The robot drove on from {STOP_DISTANCE:g} to {clearance:.2f} m from the obstacle, and the goal was "
            "aborted only when it turned: is the distance checked while it drives, too?"
        )
    return ABORTED_NEAR


def _approach(record: Record, goal: SentGoal) -> Optional[Failed]:
    """The failure of a robot that drives towards an obstacle that is too near from the start."""
    before = [sample.ahead for sample in record.samples_between(goal.time - 0.15, goal.time)]
    after = record.samples_between(goal.time, record.active_until(goal))
    nearest = min((sample.ahead for sample in after), default=math.inf)
    if not before or before[-1] >= STOP_DISTANCE - DISTANCE_NOISE or nearest >= before[-1] - DISTANCE_NOISE:
        return None
    wanted, seen = f"an abort at {before[-1]:.2f} m", f"{nearest:.2f} m ahead of it"
    cause = (
        f"The robot drove towards an obstacle that was {before[-1]:.2f} m ahead from the start: is the threshold "
        f"less than {STOP_DISTANCE:g} m, or is the distance not checked before the robot drives, or near the goal?"
    )
    return Failed(wanted, seen, goal.time, cause, Kind.MOVES_FIRST, goal)


@check("server", "beside", plot="distances")
def only_ahead_counts(record: Record, limits: Limits) -> Verdict:
    """Obstacles beside or behind the robot do not abort a goal."""
    return of_goals(record, lambda goal: wrong_success(record, goal, limits))


@check("server", "odd_scan odd_scan_wall", plot="distances")
def odd_scans(record: Record, limits: Limits) -> Verdict:
    """Ranges of inf, 0 and NaN are not obstacles, and do not hide obstacles."""
    if not record.goals:
        return NotReached("no goal was sent")
    goal = record.goals[0]
    wanted = STATUS_NAMES.index(goal.ends)
    problem = _wrong_abort(record, goal, limits) if wanted == ABORTED else wrong_ending(record, goal, wanted, limits)
    if problem is None:
        return PASSED
    problem = replace(problem, goal=goal)
    if logged(record, EXECUTE_RAISED, problem.time, goal.time) or problem.kind is Kind.MOVING:
        return problem
    hint = ""
    end = problem.time
    far = all(it.ahead > limits.abort_farthest + FAR_BEYOND for it in record.samples_between(end - AT_END, end))
    if problem.kind is Kind.ABORTED or (problem.kind is Kind.TOO_EARLY and far):  # not by another threshold
        hint = "A range of 0 or NaN is treated as an obstacle"
    elif wanted == ABORTED and problem.kind in (Kind.SUCCEEDED, Kind.NO_RESULT, Kind.TOO_FAR):
        hint = "A range of 0 or NaN hides the wall"
    hint = hint and f"{hint}: only range_min < r < range_max is a valid range"
    return replace(problem, cause=sentences(problem.cause, hint))
