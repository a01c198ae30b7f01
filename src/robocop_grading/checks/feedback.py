"""Checks of the feedback: its rate, and its errors against the true ones."""

import math
from dataclasses import replace
from functools import partial
from typing import List, Mapping, Optional, Sequence

from ..handout import GOAL_RADIUS, Limits
from ..record import ERRORS, Record, SentGoal
from .feedback_age import age_of
from .feedback_causes import TOLERANCES, UNITS, likely_cause, longest, misses
from .feedback_hypotheses import ANGLE, POSE_TOPIC, POSITION, Pair
from .topic_use import late, unpublished
from .verdict import PASSED, Failed, Kind, NotReached, Verdict, check

AGE = 0.35  # [s] allowed age of a node's data: an odometry period, a tick of its loop and a tick of the recording
MIN_COMPARED_DISTANCE = 0.15  # [m] closer than this, the direction to the goal is not compared
INEXACT = 0.02  # [m] of the position in /odom, which turns the direction of a goal that is near
MAX_WRONG = 0.1  # allowed share of wrong messages: single ones occur when a turn ends
MAX_WRONG_TIME = 0.25  # [s] messages that are wrong one after the other for so long are no transition
MIN_GOAL_TIME = 2.0  # [s] for which a goal has to be active: what a server does before its loop takes part of it
STOPS = 0.4  # [s] after a goal's end, in which a timer's last feedback may come
MAX_LATER = 3  # messages that may come even later
NO_FEEDBACK = "No feedback was sent at all: is publish_feedback called in the loop?"
TOO_OFTEN = (
    "Feedback is sent more often than 10 times a second: is rate.sleep() called in each iteration, that of "
    "rospy.Rate(10), is feedback published once in it, and does no timer or thread of an earlier goal go on?"
)
NOT_10_HZ = "Feedback is not sent in each iteration, or the loop's rate is not 10 Hz"
GOES_ON = (
    "Feedback about a goal goes on after its result: does a timer or a thread of the goal go on? Stop it when the goal "
    "ends"
)
OLD = (
    "The feedback is old, by up to {:.1f} s: calculate the errors from the newest pose, then publish them, both in the "
    "same iteration, and let callbacks return at once"
)
DIFFERENCE = "the difference of two angles has to be normalized to -pi..pi"


@check("server", "left right behind far", plot="errors")
def feedback_rate(record: Record, limits: Limits) -> Verdict:
    """While a goal is active, and not after its end, feedback is published about ten times a second."""
    judged = False
    wanted = f"about 10 Hz ({limits.feedback_low:g} to {limits.feedback_high:g})"
    for goal in record.goals:
        rate = _rate(record, goal)
        later = [it.time for it in record.feedback_of(goal) if it.time > record.active_until(goal) + STOPS]
        if rate is not None:
            judged = True
            if not limits.feedback_low <= rate <= limits.feedback_high:
                cause = NO_FEEDBACK if not rate else TOO_OFTEN if rate > limits.feedback_high else NOT_10_HZ
                kind = Kind.TOO_LITTLE if rate < limits.feedback_low else None
                return Failed(wanted, f"{rate:.1f} Hz", goal.time, cause, kind, goal)
        if len(later) > MAX_LATER:
            return Failed("no feedback after the result", f"{len(later)} messages", later[0], GOES_ON, goal=goal)
    return PASSED if judged else NotReached("no goal was active for two seconds")


def _rate(record: Record, goal: SentGoal) -> Optional[float]:
    """Feedback messages per second while a goal was active; None if that was not long enough."""
    end = min(record.active_until(goal), _arrival(record, goal))
    count = sum(message.time <= end for message in record.feedback_of(goal))
    return None if end - goal.time < MIN_GOAL_TIME else count / (end - goal.time)


def _arrival(record: Record, goal: SentGoal) -> float:
    """When [s] the robot came to the goal, or the recording ended: from then on, the server may have left its loop."""
    samples = record.samples_between(goal.time, math.inf)
    there = (sample.time for sample in samples if goal.errors_at(sample)[POSITION] < GOAL_RADIUS)
    return next(there, samples[-1].time if samples else goal.time)


def _compared(index: int, record: Record) -> List[Pair]:
    """The feedback messages by which an error is judged, each with the samples that it may be based on."""
    goals = {goal.id: goal for goal in record.goals}
    starts = {goal.id: (record.samples_between(goal.time, math.inf) or record.samples)[:1] for goal in record.goals}
    pairs = []
    for message in record.feedback:
        samples = record.samples_between(message.time - AGE, message.time + 1e-3)
        if message.id in goals and samples:
            pairs.append(Pair(message, samples, goals[message.id], starts[message.id][0], record.started))
    return [pair for pair in pairs if index == POSITION or pair.truth[POSITION] > MIN_COMPARED_DISTANCE]


def _deviation(index: int, pair: Pair) -> float:
    """Distance [m], [rad] of an error from the interval of recent true values; infinity for NaN."""
    inexact = INEXACT / max(MIN_COMPARED_DISTANCE, pair.truth[POSITION]) if index == ANGLE else 0.0
    return misses(index, [pair], lambda it: it.truth[index])[0] - inexact


def _wrong(index: int, pairs: Sequence[Pair], tolerance: float) -> List[Pair]:
    """The pairs whose error exceeds a tolerance, if there are more than a few such pairs, or some in a row."""
    deviations = [_deviation(index, pair) for pair in pairs]
    wrong = [pair for pair, deviation in zip(pairs, deviations) if deviation > tolerance]
    is_much = len(wrong) > MAX_WRONG * len(pairs) or longest(deviations, pairs, tolerance) >= MAX_WRONG_TIME
    return wrong if is_much else []


def _explained(index: int, records: Mapping[str, Record], names: Sequence[str], failure: Failed) -> Failed:
    """The failure with the causes that fit in all scenarios."""
    of_old_pose = late(records, POSE_TOPIC, "The errors are those of an old pose")
    if failure.kind is not Kind.WRONG_ERROR:
        return replace(failure, cause=of_old_pose) if of_old_pose and failure.kind is Kind.OLD_POSE else failure
    scenarios = [_compared(index, records[name]) for name in names]
    wrong = [pair for pairs in scenarios for pair in _wrong(index, pairs, TOLERANCES[index])]
    cause, found = likely_cause(index, wrong, scenarios)
    silent = unpublished(records, POSE_TOPIC)
    unchanged = any(it.unchanged for it in found)
    if unchanged and silent:
        cause = f"The errors do not change with the robot's pose: the node subscribes to {silent}, which nobody "
        cause += "publishes; the position comes from /odom"
    elif of_old_pose and (unchanged or not found):
        cause = of_old_pose
    elif not found:
        age = age_of([records[name] for name in names], index)
        return replace(failure, cause=OLD.format(age), kind=Kind.OLD_POSE) if age else replace(failure, cause=cause)
    return replace(failure, cause=cause)


@check("server", "left right behind far", plot="errors", explain=partial(_explained, POSITION))
def feedback_position(record: Record, limits: Limits) -> Verdict:
    """position_error in the feedback is the distance to the goal."""
    pairs = _compared(POSITION, record)
    if not pairs:
        return NotReached("there was no feedback")
    return _untrue(POSITION, pairs, limits.position_tolerance) or _old(record, POSITION) or PASSED


@check("server", "left right behind far", plot="errors", explain=partial(_explained, ANGLE))
def feedback_angle(record: Record, limits: Limits) -> Verdict:
    """angle_error in the feedback is the angle from the heading to the goal's direction, within +-pi."""
    pairs = _compared(ANGLE, record)
    if not pairs:
        return NotReached("there was no feedback")
    beyond = [pair for pair in pairs if abs(pair.feedback.angle_error) > math.pi + 0.05]
    unwrapped = [pair for pair in beyond if _deviation(ANGLE, pair) <= limits.angle_tolerance]
    if unwrapped and len(unwrapped) > 0.7 * len(beyond):  # single values in degrees may match by chance
        message = unwrapped[0].feedback
        wanted, seen = "an angle within +-3.14 rad", f"angle_error {message.angle_error:.2f}"
        cause = f"angle_error is not wrapped: {message.angle_error:.1f} rad; {DIFFERENCE}"
        return Failed(wanted, seen, message.time, cause)
    old = None if _old(record, POSITION) else _old(record, ANGLE)  # one mistake is counted once
    return _untrue(ANGLE, pairs, limits.angle_tolerance) or old or PASSED


def _old(record: Record, index: int) -> Optional[Failed]:
    """The failure of feedback that was true an iteration ago."""
    age = age_of([record], index)
    name, time = ERRORS[index], record.feedback[0].time
    return (
        Failed(f"the present {name}", f"one of {age:.2f} s ago", time, OLD.format(age), Kind.OLD_POSE) if age else None
    )


def _untrue(index: int, pairs: Sequence[Pair], tolerance: float) -> Optional[Failed]:
    """The first wrong value; `_explained` names its cause."""
    wrong = _wrong(index, pairs, tolerance)
    if not wrong:
        return None
    first = wrong[0]
    seen = f"{ERRORS[index]} {first.feedback.errors[index]:.2f}"
    return Failed(
        f"{first.truth[index]:.2f} {UNITS[index]}", seen, first.feedback.time, "", Kind.WRONG_ERROR, first.goal
    )
