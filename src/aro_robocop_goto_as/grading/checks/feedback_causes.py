"""Which mistake explains wrong values of the feedback: hypotheses that predict what a server would report with it."""

import math
from dataclasses import replace
from typing import Callable, Iterator, List, NamedTuple, Sequence, Tuple

from ...geometry import Pose2D, compose
from ..record import Feedback, Goal, Sample, errors_at, wrapped

FITS = 0.25  # [m], [rad] largest median error of a hypothesis
EXACT = 0.003  # [m], [rad] a hypothesis that fits better than this explains a constant value


class Pair(NamedTuple):
    """A feedback message, the samples that it may be based on, its goal, and where the robot was when that was sent."""

    feedback: Feedback
    samples: List[Sample]
    goal: Goal
    start: Sample


def _deltas(s: Sample, g: Goal) -> Tuple[float, float]:
    return g.x - s.x, g.y - s.y


def _from_start(pair: Pair) -> Goal:
    """The goal, if it is understood as a position in the robot's frame of when it was sent."""
    there = compose(Pose2D(pair.start.x, pair.start.y, pair.start.yaw), Pose2D(pair.goal.x, pair.goal.y))
    return replace(pair.goal, x=there.x, y=there.y)


def _offset_by_start(pair: Pair) -> Goal:
    """The same without the robot's heading."""
    return replace(pair.goal, x=pair.start.x + pair.goal.x, y=pair.start.y + pair.goal.y)


RELATIVE = "The goal is taken relative to the robot, where it is when the goal comes; goals are in odom"
MISREAD: Tuple[Callable[[Pair], Goal], ...] = (_from_start, _offset_by_start)
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


def _predictions(name: str, pairs: Sequence[Pair], causes: Sequence[Hypothesis]) -> Iterator[Tuple[str, List[float]]]:
    """For each cause the values that it would lead to."""
    index = ("position_error", "angle_error").index(name)
    for cause, predict in causes:
        yield cause, [predict(pair.samples[-1], pair.goal) for pair in pairs]
    for misread in MISREAD:
        yield RELATIVE, [errors_at(pair.samples[-1], misread(pair))[index] for pair in pairs]


def likely_cause(
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
    return misses[len(misses) // 2] / (1.0 if max(abs(value) for value in values) < 7.0 else 10.0)
