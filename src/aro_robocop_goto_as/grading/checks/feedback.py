"""Checks of the feedback: its rate, and its errors against the true ones."""

import math
from typing import Callable, List, Sequence

from ..check_limits import Limits
from ..record import Record, errors_at, results_of, samples_between, wrapped
from .consequences import silenced_by
from .feedback_causes import (
    ANGLE_CAUSES,
    POSITION_CAUSES,
    POSITION_UNUSED,
    RELATIVE,
    WORLD,
    Hypothesis,
    Pair,
    likely_cause,
)
from .verdict import Earlier, Failed, NotReached, Passed, Verdict, check

AGE = 0.35  # [s] allowed age of a node's data: an odometry period, a tick of its loop and a tick of the recording
NEAR = 0.15  # [m] closer than this, the direction to the goal is not compared
MOST_WRONG = 0.1  # allowed share of wrong messages: single ones occur when a turn ends
LONGEST_WRONG = 0.25  # [s] messages that are wrong one after the other for so long are no transition
SHORTEST = 1.0  # [s] shorter goals say nothing about a rate


@check("errors")
def feedback_rate(record: Record, limits: Limits) -> Verdict:
    """While a goal is active, feedback is published about ten times a second."""
    judged = False
    for goal in record.goals:
        results = results_of(record, goal)
        end = results[0].time if results else record.samples[-1].time if record.samples else goal.time
        if end - goal.time < SHORTEST:
            continue
        judged = True
        count = sum(message.id == goal.id for message in record.feedback)
        rate = count / (end - goal.time)
        if limits.feedback_low <= rate <= limits.feedback_high:
            continue
        if not count:
            cause = "No feedback was sent at all: is publish_feedback called in the loop?"
        elif rate > limits.feedback_high:
            cause = "The loop is not paced: is rate.sleep() called in each iteration?"
        else:
            cause = "Feedback is not sent in each iteration, or the loop's rate is not 10 Hz"
        wanted = f"about 10 Hz ({limits.feedback_low:g} to {limits.feedback_high:g})"
        seen = f"{rate:.1f} Hz, {count} messages in {end - goal.time:.1f} s"
        return Failed(wanted, seen, goal.time, cause, silenced_by(record, goal))
    return Passed() if judged else NotReached("no goal was active for a second")


def _pairs(record: Record) -> List[Pair]:
    goals = {goal.id: goal for goal in record.goals}
    starts = {goal.id: (samples_between(record, goal.time, math.inf) or record.samples)[:1] for goal in record.goals}
    pairs = []
    for message in record.feedback:
        samples = samples_between(record, message.time - AGE, message.time + 1e-3)
        if message.id in goals and samples:
            pairs.append(Pair(message, samples, goals[message.id], starts[message.id][0]))
    return pairs


def _wrong(pairs: Sequence[Pair], error: Callable[[Pair], float], tolerance: float) -> List[Pair]:
    """The pairs whose error exceeds a tolerance, if there are more than a few of them, or some in a row."""
    wrong: List[Pair] = []
    longest, row = 0.0, math.inf  # [s] how long a row of wrong messages was, when the present one began
    for pair in pairs:
        if error(pair) > tolerance:
            wrong.append(pair)
            row = min(row, pair.feedback.time)
            longest = max(longest, pair.feedback.time - row)
        else:
            row = math.inf
    return wrong if len(wrong) > MOST_WRONG * len(pairs) or longest >= LONGEST_WRONG else []


def _position_deviation(pair: Pair) -> float:
    """Distance [m] of a position_error from the interval of recent true values; infinity for NaN."""
    value, truths = pair.feedback.position_error, [errors_at(sample, pair.goal)[0] for sample in pair.samples]
    if not math.isfinite(value):
        return math.inf
    return max(0.0, min(truths) - value, value - max(truths))


def _angle_deviation(pair: Pair) -> float:
    """The same for an angle_error [rad], with the interval taken around the first true value."""
    value, truths = pair.feedback.angle_error, [errors_at(sample, pair.goal)[1] for sample in pair.samples]
    if not math.isfinite(value):
        return math.inf
    spread = [wrapped(truth - truths[0]) for truth in truths]
    middle = truths[0] + (min(spread) + max(spread)) / 2.0
    return max(0.0, abs(wrapped(value - middle)) - (max(spread) - min(spread)) / 2.0)


@check("errors")
def feedback_position(record: Record, limits: Limits) -> Verdict:
    """position_error in the feedback is the distance to the goal."""
    pairs = _pairs(record)
    if not pairs:
        return NotReached("there was no feedback")
    wrong = _wrong(pairs, _position_deviation, limits.position_tolerance)
    otherwise = "position_error is not the distance from the position in /odom to the goal"
    return _failed(wrong, pairs, 0, "m", POSITION_CAUSES, otherwise) if wrong else Passed()


@check("errors")
def feedback_angle(record: Record, limits: Limits) -> Verdict:
    """angle_error in the feedback is the angle from the heading to the goal's direction, within +-pi."""
    pairs = [pair for pair in _pairs(record) if errors_at(pair.samples[-1], pair.goal)[0] > NEAR]
    if not pairs:
        return NotReached("there was no feedback")
    beyond = [pair for pair in pairs if abs(pair.feedback.angle_error) > math.pi + 0.05]
    unwrapped = [pair for pair in beyond if _angle_deviation(pair) <= limits.angle_tolerance]
    if unwrapped and len(unwrapped) > 0.7 * len(beyond):  # single values in degrees may match by chance
        message = unwrapped[0].feedback
        cause = (
            f"angle_error is not wrapped: {message.angle_error:.1f} rad; the difference of two angles has to be "
            "normalized to -pi..pi"
        )
        seen = f"angle_error {message.angle_error:.2f}"
        return Failed("an angle within +-3.14 rad", seen, message.time, cause)
    wrong = _wrong(pairs, _angle_deviation, limits.angle_tolerance)
    otherwise = "angle_error is not the goal's direction minus the heading, both in odom"
    return _failed(wrong, pairs, 1, "rad", ANGLE_CAUSES, otherwise) if wrong else Passed()


def _failed(
    wrong: Sequence[Pair], pairs: Sequence[Pair], index: int, unit: str, causes: Sequence[Hypothesis], otherwise: str
) -> Failed:
    """The first wrong value with the likely cause of all of them, among all pairs; `index` as in errors_at."""
    name = ("position_error", "angle_error")[index]
    value = getattr(wrong[0].feedback, name)
    truth = errors_at(wrong[0].samples[-1], wrong[0].goal)[index]
    cause = likely_cause(name, wrong, pairs, causes, otherwise)
    of_position = cause.endswith((RELATIVE, POSITION_UNUSED, WORLD))
    follows = (Earlier("feedback_position"),) if of_position else ()
    return Failed(f"{truth:.2f} {unit}", f"{name} {value:.2f}", wrong[0].feedback.time, cause, follows)
