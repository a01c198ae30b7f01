"""Feedback: how often, and whether its errors are the true ones."""

import math
from typing import Callable, List, Optional, Sequence, Tuple

from ..plan import Limits
from ..record import Feedback, Goal, Record, Sample, end_of, errors_at, samples_between, wrapped
from .verdict import Failed, NotReached, Passed, Verdict, check

AGE = 0.35  # [s] a node's data may be as old: one odometry period, one tick of its loop, one of ours
NEAR = 0.15  # [m] nearer to the goal its direction means nothing
MOST_WRONG = 0.1  # share of messages that may be off: single ones at a turn's end are
EXACT = 0.003  # [m], [rad] nearer than this a constant is no chance, but what a wrong formula gives
SHORTEST = 1.0  # [s] of a goal that says anything about a rate

Pair = Tuple[Feedback, List[Sample], Goal]


@check("errors")
def feedback_rate(record: Record, limits: Limits) -> Verdict:
    """While a goal is pursued, feedback comes about ten times a second."""
    worst: Optional[Failed] = None
    judged = False
    for goal in record.goals:
        ends = end_of(record, goal)
        until = ends[0].time if ends else record.samples[-1].time if record.samples else goal.time
        if until - goal.time < SHORTEST:
            continue
        judged = True
        count = sum(1 for it in record.feedback if it.id == goal.id)
        rate = count / (until - goal.time)
        if not limits.feedback_low <= rate <= limits.feedback_high:
            cause = (
                "no feedback was sent at all: is publish_feedback called in the loop?"
                if not count
                else "the loop is not paced: is rate.sleep() called in each iteration?"
                if rate > limits.feedback_high
                else "feedback is not sent in each iteration, or the loop's rate is not 10 Hz"
            )
            worst = worst or Failed(
                f"about 10 Hz ({limits.feedback_low:g} to {limits.feedback_high:g})",
                f"{rate:.1f} Hz, {count} messages in {until - goal.time:.1f} s",
                goal.time,
                cause,
            )
    return worst or (Passed() if judged else NotReached("no goal was pursued for a second"))


def _pairs(record: Record) -> List[Pair]:
    """Feedback with its goal and with the truth of the time it may speak of."""
    goals = {goal.id: goal for goal in record.goals}
    found = []
    for it in record.feedback:
        goal = goals.get(it.id)
        if goal is not None:
            around = samples_between(record, it.time - AGE, it.time + 1e-3)
            if around:
                found.append((it, around, goal))
    return found


def _position_off(pair: Pair) -> float:
    """How far [m] a position_error is outside of what was true lately; NaN is infinitely far."""
    value, truths = pair[0].position_error, [errors_at(sample, pair[2])[0] for sample in pair[1]]
    if not math.isfinite(value):
        return math.inf
    return max(0.0, min(truths) - value, value - max(truths))


def _angle_off(pair: Pair) -> float:
    """The same for an angle_error [rad]: the truths lie on the short way from the first one."""
    value, truths = pair[0].angle_error, [errors_at(sample, pair[2])[1] for sample in pair[1]]
    if not math.isfinite(value):
        return math.inf
    spread = [wrapped(truth - truths[0]) for truth in truths]
    middle = truths[0] + (min(spread) + max(spread)) / 2.0
    return max(0.0, abs(wrapped(value - middle)) - (max(spread) - min(spread)) / 2.0)


@check("errors")
def feedback_position(record: Record, limits: Limits) -> Verdict:
    """position_error in the feedback is the distance to the goal."""
    pairs = _pairs(record)
    wrong = [pair for pair in pairs if _position_off(pair) > limits.position_tolerance]
    if not pairs:
        return NotReached("there was no feedback")
    if len(wrong) <= MOST_WRONG * len(pairs):
        return Passed()
    otherwise = "position_error is not the distance from /odom's position to the goal"
    return _failed(wrong, 0, "m", POSITION_CAUSES, otherwise)


@check("errors")
def feedback_angle(record: Record, limits: Limits) -> Verdict:
    """angle_error in the feedback is the angle from the heading to the goal's direction, within +-pi."""
    pairs = [pair for pair in _pairs(record) if errors_at(pair[1][-1], pair[2])[0] > NEAR]
    if not pairs:
        return NotReached("there was no feedback")
    beyond = [pair for pair in pairs if abs(pair[0].angle_error) > math.pi + 0.05]
    unwrapped = [pair for pair in beyond if _angle_off(pair) <= limits.angle_tolerance]
    if unwrapped and len(unwrapped) > 0.7 * len(beyond):  # degrees may be right by chance, once in a while
        it = unwrapped[0][0]
        return Failed(
            "an angle within +-3.14 rad",
            f"angle_error is {it.angle_error:.2f}",
            it.time,
            f"angle error not wrapped: {it.angle_error:.1f} rad; the difference of two angles has to be "
            "brought back to -pi..pi",
        )
    wrong = [pair for pair in pairs if _angle_off(pair) > limits.angle_tolerance]
    if len(wrong) <= MOST_WRONG * len(pairs):
        return Passed()
    otherwise = "angle_error is not the goal's direction minus the heading, both in odom"
    return _failed(wrong, 1, "rad", ANGLE_CAUSES, otherwise)


def _deltas(s: Sample, g: Goal) -> Tuple[float, float]:
    return g.x - s.x, g.y - s.y


Hypothesis = Tuple[str, Callable[[Sample, Goal], float]]
POSITION_CAUSES: Tuple[Hypothesis, ...] = (
    (
        "the robot's position is taken from /ground_truth_odom, whose frame is world; goals are in odom",
        lambda s, g: math.hypot(g.x - s.world_x, g.y - s.world_y),
    ),
    (
        "it is the goal's distance from odom's origin: the robot's position is left out, or read only at the start",
        lambda s, g: math.hypot(g.x, g.y),
    ),
    ("it is the distance squared: the square root lacks", lambda s, g: sum(d * d for d in _deltas(s, g))),
    ("only x counts in it", lambda s, g: abs(_deltas(s, g)[0])),
    ("only y counts in it", lambda s, g: abs(_deltas(s, g)[1])),
    ("it is |dx| + |dy|, not the straight line", lambda s, g: sum(abs(d) for d in _deltas(s, g))),
    ("its sign is wrong", lambda s, g: -math.hypot(*_deltas(s, g))),
    ("it is always zero: position_error is never filled", lambda s, g: 0.0),
    ("it holds the angle error: the two are swapped", lambda s, g: errors_at(s, g)[1]),
)
ANGLE_CAUSES: Tuple[Hypothesis, ...] = (
    ("it is in degrees; the handout wants radians", lambda s, g: math.degrees(errors_at(s, g)[1])),
    ("its sign is wrong: it has to be the goal's direction minus the heading", lambda s, g: -errors_at(s, g)[1]),
    (
        "it is the goal's direction in odom: the robot's heading is left out, or read only at the start",
        lambda s, g: math.atan2(_deltas(s, g)[1], _deltas(s, g)[0]),
    ),
    ("the heading is added instead of subtracted", lambda s, g: math.atan2(*_deltas(s, g)[::-1]) + s.yaw),
    ("atan2 gets x before y; it is atan2(dy, dx)", lambda s, g: math.atan2(*_deltas(s, g)) - s.yaw),
    (
        "atan instead of atan2: a goal behind looks like one ahead",
        lambda s, g: math.atan(_deltas(s, g)[1] / (_deltas(s, g)[0] or 1e-9)) - s.yaw,
    ),
    (
        "the heading is orientation.z itself, a part of the quaternion and not an angle",
        lambda s, g: math.atan2(*_deltas(s, g)[::-1]) - math.sin(s.yaw / 2.0),
    ),
    (
        "the heading is taken from /ground_truth_odom, whose frame is world; goals are in odom",
        lambda s, g: math.atan2(g.y - s.world_y, g.x - s.world_x) - s.world_yaw,
    ),
    (
        "it is the goal's direction from odom's origin: the robot's position is left out",
        lambda s, g: math.atan2(g.y, g.x) - s.yaw,
    ),
    ("it has no sign: right and left can't be told apart", lambda s, g: abs(errors_at(s, g)[1])),
    ("it is always zero: angle_error is never filled", lambda s, g: 0.0),
    ("it holds the distance: the two are swapped", lambda s, g: errors_at(s, g)[0]),
)


def _failed(wrong: Sequence[Pair], which: int, unit: str, causes: Sequence[Hypothesis], otherwise: str) -> Failed:
    """The first wrong value, with what explains them all best; `which`: as in errors_at."""
    name = ("position_error", "angle_error")[which]
    values = [getattr(pair[0], name) for pair in wrong]
    it, around, goal = wrong[0]
    return Failed(f"{errors_at(around[-1], goal)[which]:.2f} {unit}", f"{name} is {values[0]:.2f}", it.time,
                  _likely(values, [(pair[1][-1], pair[2]) for pair in wrong], causes, otherwise, which == 1))


def _likely(
    seen: Sequence[float],
    truths: Sequence[Tuple[Sample, Goal]],
    hypotheses: Sequence[Hypothesis],
    otherwise: str,
    angles: bool,
) -> str:
    """The hypothesis that explains what was seen best, if any does."""
    if not all(map(math.isfinite, seen)):
        return "it is not a number at times"
    best, least = otherwise, 0.25
    for words, predict in hypotheses:
        off = []
        for value, (sample, goal) in zip(seen, truths):
            miss = value - predict(sample, goal)
            off.append(abs(wrapped(miss) if angles and abs(value) < 4.0 else miss))
        middle = sorted(off)[len(off) // 2]
        scale = 1.0 if max(abs(value) for value in seen) < 7.0 else 10.0  # degrees and squares move in larger steps
        if middle / scale < least:
            best, least = words, middle / scale
    if len(set(seen)) == 1 and len(seen) > 5 and seen[0] != 0.0 and least > EXACT:
        return (f"it is always {seen[0]:.2f}: it is not calculated anew in each iteration, or from a pose that is not "
                "read anew")
    return best
