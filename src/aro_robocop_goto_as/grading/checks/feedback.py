"""Checks of the feedback: its rate, and its errors against the true ones."""

import math
from dataclasses import replace
from typing import Callable, Iterator, List, NamedTuple, Sequence, Tuple

from ...geometry import Pose2D, compose
from ..limits import Limits
from ..record import Feedback, Goal, Record, Sample, errors_at, results_of, samples_between, wrapped
from .consequences import silenced_by
from .verdict import Earlier, Failed, NotReached, Passed, Verdict, check

AGE = 0.35  # [s] allowed age of a node's data: an odometry period, a tick of its loop and a tick of the recording
NEAR = 0.15  # [m] closer than this, the direction to the goal is not compared
MOST_WRONG = 0.1  # allowed share of wrong messages: single ones occur when a turn ends
LONGEST_WRONG = 0.25  # [s] messages that are wrong one after the other for so long are no transition
FITS = 0.25  # [m], [rad] largest median error of a hypothesis
EXACT = 0.003  # [m], [rad] a hypothesis that fits better than this explains a constant value
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


class Pair(NamedTuple):
    """A feedback message, the samples that it may be based on, its goal, and where the robot was when that was sent."""

    feedback: Feedback
    samples: List[Sample]
    goal: Goal
    start: Sample


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


def _deltas(s: Sample, g: Goal) -> Tuple[float, float]:
    return g.x - s.x, g.y - s.y


def _from_start(pair: Pair) -> Goal:
    """The goal, if it is understood as a position in the robot's frame of when it was sent."""
    there = compose(Pose2D(pair.start.x, pair.start.y, pair.start.yaw), Pose2D(pair.goal.x, pair.goal.y))
    return replace(pair.goal, x=there.x, y=there.y)


def _offset_by_start(pair: Pair) -> Goal:
    """The same without the robot's heading."""
    return replace(pair.goal, x=pair.start.x + pair.goal.x, y=pair.start.y + pair.goal.y)


def _relative_to(pair: Pair) -> Goal:
    """The goal, if it is understood as a position in the robot's present frame."""
    at = pair.samples[-1]
    there = compose(Pose2D(at.x, at.y, at.yaw), Pose2D(pair.goal.x, pair.goal.y))
    return replace(pair.goal, x=there.x, y=there.y)


RELATIVE = "The goal is taken relative to the robot, where it is"
MISREAD: Tuple[Tuple[str, Callable[[Pair], Goal]], ...] = (
    (f"{RELATIVE} when the goal comes; goals are in odom", _from_start),
    (f"{RELATIVE} when the goal comes; goals are in odom", _offset_by_start),
    (f"{RELATIVE} at the moment; goals are in odom", _relative_to),
)
POSITION_UNUSED = "the robot's position is left out, or read only at the start"
WORLD = "in the world or map frame; goals are in odom"
Hypothesis = Tuple[str, Callable[[Sample, Goal], float]]
POSITION_CAUSES: Tuple[Hypothesis, ...] = (
    (
        f"The robot's position is taken {WORLD}",
        lambda s, g: math.hypot(g.x - s.world_x, g.y - s.world_y),
    ),
    (
        f"position_error is measured from odom's origin: {POSITION_UNUSED}",
        lambda s, g: math.hypot(g.x, g.y),
    ),
    (
        "position_error is the squared distance: the square root is missing",
        lambda s, g: sum(d * d for d in _deltas(s, g)),
    ),
    ("position_error depends on x only", lambda s, g: abs(_deltas(s, g)[0])),
    ("position_error depends on y only", lambda s, g: abs(_deltas(s, g)[1])),
    (
        "position_error is |dx| + |dy| instead of the straight-line distance",
        lambda s, g: sum(abs(d) for d in _deltas(s, g)),
    ),
    ("The sign of position_error is wrong", lambda s, g: -math.hypot(*_deltas(s, g))),
    ("position_error is always zero: it is never filled in", lambda s, g: 0.0),
    ("position_error is the angle error: the two are swapped", lambda s, g: errors_at(s, g)[1]),
)
ANGLE_CAUSES: Tuple[Hypothesis, ...] = (
    ("angle_error is in degrees; the handout wants radians", lambda s, g: math.degrees(errors_at(s, g)[1])),
    (
        "The sign of angle_error is wrong: it has to be the goal's direction minus the heading",
        lambda s, g: -errors_at(s, g)[1],
    ),
    (
        "angle_error is the goal's direction in odom: the robot's heading is left out, or read only at the start",
        lambda s, g: math.atan2(_deltas(s, g)[1], _deltas(s, g)[0]),
    ),
    ("The heading is added instead of subtracted", lambda s, g: math.atan2(*_deltas(s, g)[::-1]) + s.yaw),
    ("The arguments of atan2 are swapped: it is atan2(dy, dx)", lambda s, g: math.atan2(*_deltas(s, g)) - s.yaw),
    (
        "atan is used instead of atan2: a goal behind looks like one ahead",
        lambda s, g: math.atan(_deltas(s, g)[1] / (_deltas(s, g)[0] or 1e-9)) - s.yaw,
    ),
    (
        "The heading is orientation.z, which is a component of the quaternion and not an angle",
        lambda s, g: math.atan2(*_deltas(s, g)[::-1]) - math.sin(s.yaw / 2.0),
    ),
    (
        f"The heading is taken {WORLD}",
        lambda s, g: math.atan2(g.y - s.world_y, g.x - s.world_x) - s.world_yaw,
    ),
    (
        f"angle_error is the goal's direction from odom's origin: {POSITION_UNUSED}",
        lambda s, g: math.atan2(g.y, g.x) - s.yaw,
    ),
    ("angle_error has no sign: left and right can't be distinguished", lambda s, g: abs(errors_at(s, g)[1])),
    ("angle_error is always zero: it is never filled in", lambda s, g: 0.0),
    ("angle_error is the distance: the two are swapped", lambda s, g: errors_at(s, g)[0]),
)


def _failed(
    wrong: Sequence[Pair], pairs: Sequence[Pair], index: int, unit: str, causes: Sequence[Hypothesis], otherwise: str
) -> Failed:
    """The first wrong value with the likely cause of all of them, among all pairs; `index` as in errors_at."""
    name = ("position_error", "angle_error")[index]
    value = getattr(wrong[0].feedback, name)
    truth = errors_at(wrong[0].samples[-1], wrong[0].goal)[index]
    cause = _likely_cause(name, wrong, pairs, causes, otherwise)
    of_position = cause.startswith(RELATIVE) or cause.endswith((POSITION_UNUSED, WORLD))
    follows = (Earlier("feedback_position"),) if of_position else ()
    return Failed(f"{truth:.2f} {unit}", f"{name} {value:.2f}", wrong[0].feedback.time, cause, follows)


def _predictions(name: str, pairs: Sequence[Pair], causes: Sequence[Hypothesis]) -> Iterator[Tuple[str, List[float]]]:
    """For each cause the values that it would lead to."""
    index = ("position_error", "angle_error").index(name)
    for cause, predict in causes:
        yield cause, [predict(pair.samples[-1], pair.goal) for pair in pairs]
    for cause, misread in MISREAD:
        yield cause, [errors_at(pair.samples[-1], misread(pair))[index] for pair in pairs]


def _likely_cause(
    name: str, wrong: Sequence[Pair], pairs: Sequence[Pair], causes: Sequence[Hypothesis], otherwise: str
) -> str:
    """The hypothesis that fits the wrong values best, if one fits these and all values.

    A few wrong values fit many hypotheses, which the right ones then contradict.
    """
    values = [getattr(pair.feedback, name) for pair in wrong]
    if not all(map(math.isfinite, values)):
        return f"Some values of {name} are not finite"
    best, least = otherwise, FITS
    for (cause, of_wrong), (_, of_all) in zip(_predictions(name, wrong, causes), _predictions(name, pairs, causes)):
        miss = _miss(name, wrong, of_wrong)
        if miss < least and _miss(name, pairs, of_all) < FITS:
            best, least = cause, miss
    if len(set(values)) == 1 and len(values) > 5 and values[0] != 0.0 and least > EXACT:
        return f"{name} is always {values[0]:.2f}: recalculate it in each iteration from the newest pose"
    return best


def _miss(name: str, pairs: Sequence[Pair], predicted: Sequence[float]) -> float:
    """The median difference between values and predictions; degrees and squares, which vary more, are scaled."""
    values = [getattr(pair.feedback, name) for pair in pairs]
    misses = sorted(
        abs(wrapped(value - prediction) if name == "angle_error" and abs(value) < 4.0 else value - prediction)
        for value, prediction in zip(values, predicted)
    )
    return misses[len(misses) // 2] / (1.0 if max(map(abs, values)) < 7.0 else 10.0)
