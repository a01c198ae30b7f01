"""Checks of the feedback: its rate, and its errors against the true ones."""

import math
from dataclasses import replace
from functools import partial
from typing import List, Mapping, Optional, Sequence

import numpy as np

from ..handout import GOAL_RADIUS, Limits
from ..record import ERRORS, Goal, Record, active_until, errors_at, feedback_of, samples_between, wrapped
from .feedback_causes import OTHERWISE, TOLERANCES, UNITS, likely_cause, longest, misses
from .feedback_hypotheses import ANGLE, OF_POSITION, POSE_TOPIC, POSITION, UNCHANGED, Pair
from .topic_use import late, unpublished
from .verdict import PASSED, Failed, Kind, NotReached, Verdict, check

AGE = 0.35  # [s] allowed age of a node's data: an odometry period, a tick of its loop and a tick of the recording
NEAR = 0.15  # [m] closer than this, the direction to the goal is not compared
INEXACT = 0.02  # [m] of the position in /odom, which turns the direction of a goal that is near
MAX_WRONG = 0.1  # allowed share of wrong messages: single ones occur when a turn ends
MAX_WRONG_TIME = 0.25  # [s] messages that are wrong one after the other for so long are no transition
AGES = np.arange(0.0, 0.305, 0.01)  # [s] of the pose that feedback may be of
OLD = 0.085  # [s] a server that waits for odometry and then for a scan is 0.07 s late; an iteration is 0.1 s
MOVING = 10  # fewer messages say nothing about their age
CHANGED = 0.02  # [m], [rad] change of an error within the oldest of the AGES
MAX_DIFFERENCE = 0.2  # [m], [rad] that counts of a difference
STEADY = 0.005  # [m], [rad] smaller changes of an error are none
SHIFT = 0.015  # [m], [rad] larger constant differences are no inexactness of /odom
MIN_GOAL_TIME = 1.0  # [s] shorter goals say nothing about a rate
NO_FEEDBACK = "No feedback was sent at all: is publish_feedback called in the loop?"
TOO_OFTEN = (
    "Feedback is sent more often than 10 times a second: is rate.sleep() called in each iteration, that of "
    "rospy.Rate(10), and is feedback published once in it?"
)
NOT_10_HZ = "Feedback is not sent in each iteration, or the loop's rate is not 10 Hz"
DIFFERENCE = "the difference of two angles has to be normalized to -pi..pi"


@check("errors")
def feedback_rate(record: Record, limits: Limits) -> Verdict:
    """While a goal is active, feedback is published about ten times a second."""
    judged = False
    for goal in record.goals:
        end = min(active_until(record, goal), _arrival(record, goal))
        if end - goal.time < MIN_GOAL_TIME:
            continue
        judged = True
        count = sum(message.time <= end for message in feedback_of(record, goal))
        rate = count / (end - goal.time)
        if limits.feedback_low <= rate <= limits.feedback_high:
            continue
        cause = NO_FEEDBACK if not count else TOO_OFTEN if rate > limits.feedback_high else NOT_10_HZ
        wanted = f"about 10 Hz ({limits.feedback_low:g} to {limits.feedback_high:g})"
        seen = f"{rate:.1f} Hz, {count} messages in {end - goal.time:.1f} s"
        return Failed(wanted, seen, goal.time, cause, goal=goal)
    return PASSED if judged else NotReached("no goal was active for a second")


def _arrival(record: Record, goal: Goal) -> float:
    """When [s] the robot came to the goal, or the recording ended: from then on, the server may have left its loop."""
    samples = samples_between(record, goal.time, math.inf)
    there = (sample.time for sample in samples if errors_at(sample, goal)[POSITION] < GOAL_RADIUS)
    return next(there, samples[-1].time if samples else goal.time)


def _compared(index: int, record: Record) -> List[Pair]:
    """The feedback messages by which an error is judged, each with the samples that it may be based on."""
    goals = {goal.id: goal for goal in record.goals}
    starts = {goal.id: (samples_between(record, goal.time, math.inf) or record.samples)[:1] for goal in record.goals}
    pairs = []
    for message in record.feedback:
        samples = samples_between(record, message.time - AGE, message.time + 1e-3)
        if message.id in goals and samples:
            pairs.append(Pair(message, samples, goals[message.id], starts[message.id][0]))
    return [pair for pair in pairs if index == POSITION or pair.truth[POSITION] > NEAR]


def _deviation(index: int, pair: Pair) -> float:
    """Distance [m], [rad] of an error from the interval of recent true values; infinity for NaN."""
    inexact = INEXACT / max(NEAR, pair.truth[POSITION]) if index == ANGLE else 0.0
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
    if found & UNCHANGED and silent:
        cause = f"The errors do not change with the robot's pose: the node subscribes to {silent}, which nobody "
        cause += "publishes; the position comes from /odom"
    elif of_old_pose and (found & UNCHANGED or cause == OTHERWISE[index]):
        cause = of_old_pose
    return replace(failure, cause=cause, kind=Kind.WRONG_POSITION if found & OF_POSITION else Kind.WRONG_ERROR)


@check("errors", explain=partial(_explained, POSITION))
def feedback_position(record: Record, limits: Limits) -> Verdict:
    """position_error in the feedback is the distance to the goal."""
    pairs = _compared(POSITION, record)
    if not pairs:
        return NotReached("there was no feedback")
    return _untrue(POSITION, pairs, limits.position_tolerance) or _old(record, POSITION) or PASSED


@check("errors", explain=partial(_explained, ANGLE))
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
    """Name the failure of feedback that was true an iteration ago."""
    differences = [_differences(record, goal, index) for goal in record.goals]
    rows = np.concatenate([np.zeros((0, len(AGES))), *differences])
    if len(rows) < MOVING:
        return None
    means = rows.mean(axis=0)
    best = int(means.argmin())
    if AGES[best] < OLD or means[best] > 0.5 * means[0] or _is_shifted(record, index):
        return None
    name, seen = ERRORS[index], f"one of {AGES[best]:.2f} s ago"
    cause = (
        f"{name} in the feedback is old: calculate it from the newest pose, then publish the feedback, both in the "
        "same iteration, and let callbacks return at once"
    )
    return Failed(f"the present {name}", seen, record.feedback[0].time, cause, Kind.OLD_POSE)


def _is_shifted(record: Record, index: int) -> bool:
    """Return whether an error is wrong even while the true error does not change: then it is not merely old."""
    differences = []
    for pair in _compared(index, record):
        truths = [errors_at(sample, pair.goal)[index] for sample in pair.samples]
        if max(truths) - min(truths) < STEADY:
            difference = pair.feedback.errors[index] - truths[-1]
            differences.append(wrapped(difference) if index == ANGLE else difference)
    return bool(differences) and abs(float(np.median(differences))) > SHIFT


def _differences(record: Record, goal: Goal, index: int) -> np.ndarray:
    """For each message while the true error changes, and each of the AGES, the difference from the error of then."""
    samples = samples_between(record, goal.time - AGES[-1] - 0.2, active_until(record, goal))
    own = feedback_of(record, goal)
    if len(samples) < 2 or not own:
        return np.zeros((0, len(AGES)))
    values = np.array([message.errors[index] for message in own])
    truth = np.array([errors_at(sample, goal)[index] for sample in samples])
    truth = np.unwrap(truth) if index == ANGLE else truth
    sampled = [sample.time for sample in samples]
    times = np.array([message.time for message in own])
    then = np.array([np.interp(times - age, sampled, truth) for age in AGES]).T
    differences = values[:, None] - then
    if index == ANGLE:
        differences = np.remainder(differences + np.pi, 2.0 * np.pi) - np.pi
    moving = np.abs(then[:, 0] - then[:, -1]) > CHANGED
    return np.minimum(np.abs(differences), MAX_DIFFERENCE)[moving & np.isfinite(values)]


def _untrue(index: int, pairs: Sequence[Pair], tolerance: float) -> Optional[Failed]:
    """The first wrong value; `_explained` names its cause."""
    wrong = _wrong(index, pairs, tolerance)
    if not wrong:
        return None
    first = wrong[0]
    seen = f"{ERRORS[index]} {first.feedback.errors[index]:.2f}"
    return Failed(f"{first.truth[index]:.2f} {UNITS[index]}", seen, first.feedback.time, "", Kind.WRONG_ERROR)
