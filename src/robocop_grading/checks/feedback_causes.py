"""Which mistake explains wrong values of the feedback: hypotheses that predict what a server would report with it."""

import math
from dataclasses import replace
from typing import Callable, Iterator, List, NamedTuple, Sequence, Tuple

from aro_robocop_goto_as.geometry import Pose2D, compose

from ..record import ERRORS, Feedback, Goal, Sample, errors_at, wrapped
from ..texts import text

FITS = 0.1  # [m], [rad] largest median error of a hypothesis
OFFSET = 0.05  # [m], [rad] a smaller constant difference is none
POSITION, ANGLE = range(2)  # indices of ERRORS
UNITS = ("m", "rad")
EXACT = 0.003  # [m], [rad] a hypothesis that fits better than this explains a constant value


class Pair(NamedTuple):
    """A feedback message, the samples that it may be based on, its goal, and where the robot was when that was sent."""

    feedback: Feedback
    samples: List[Sample]
    goal: Goal
    start: Sample

    @property
    def truth(self) -> Tuple[float, float]:
        """Both true errors."""
        return errors_at(self.samples[-1], self.goal)


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
DIRECTION_ONCE = (
    "The goal's direction is that from where the robot is when the goal comes, or from odom's origin: calculate it in "
    "each iteration from the newest position"
)
MISREAD: Tuple[Callable[[Pair], Goal], ...] = (_from_start, _offset_by_start)
POSITION_UNUSED = "the robot's position is left out, or read only at the start"
WORLD = "in the world or map frame; goals are in odom"
Hypothesis = Tuple[str, Callable[[Sample, Goal], float]]
POSITION_CAUSES: Tuple[Hypothesis, ...] = (
    (
        text("The robot's position is taken {}", WORLD),
        lambda s, g: math.hypot(g.x - s.world_x, g.y - s.world_y),
    ),
    (
        text("position_error is measured from odom's origin: {}", POSITION_UNUSED),
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
        "angle_error is the goal's direction in odom, as if the heading were 0: the heading is left out, read only at "
        "the start, or calculated wrongly from the quaternion, whose order is x, y, z, w",
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
        text("The heading is taken {}", WORLD),
        lambda s, g: math.atan2(g.y - s.world_y, g.x - s.world_x) - s.world_yaw,
    ),
    (
        text("angle_error is the goal's direction from odom's origin: {}", POSITION_UNUSED),
        lambda s, g: math.atan2(g.y, g.x) - s.yaw,
    ),
    ("angle_error has no sign: left and right can't be distinguished", lambda s, g: abs(errors_at(s, g)[1])),
    ("angle_error is always zero: it is never filled in", lambda s, g: 0.0),
    ("angle_error is the distance: the two are swapped", lambda s, g: errors_at(s, g)[0]),
)


def _direction_at_start(pair: Pair) -> float:
    """The angle_error of a server that calculates the goal's direction only when the goal comes."""
    return wrapped(math.atan2(pair.goal.y - pair.start.y, pair.goal.x - pair.start.x) - pair.samples[-1].yaw)


def _predictions(index: int, pairs: Sequence[Pair], causes: Sequence[Hypothesis]) -> Iterator[Tuple[str, List[float]]]:
    """For each cause the values that it would lead to."""
    for cause, predict in causes:
        yield cause, [predict(pair.samples[-1], pair.goal) for pair in pairs]
    if index == ANGLE:
        yield DIRECTION_ONCE, [_direction_at_start(pair) for pair in pairs]
    for misread in MISREAD:
        yield RELATIVE, [errors_at(pair.samples[-1], misread(pair))[index] for pair in pairs]


def _knows_position(pairs: Sequence[Pair]) -> bool:
    """Whether position_error is right, so that the robot's position is used."""
    return _miss(POSITION, pairs, [pair.truth[POSITION] for pair in pairs]) < FITS


def likely_cause(
    index: int, wrong: Sequence[Pair], pairs: Sequence[Pair], causes: Sequence[Hypothesis], otherwise: str
) -> str:
    """The hypothesis that fits the wrong values best, if one fits these and all values.

    A few wrong values fit many hypotheses, which the right ones then contradict.
    """
    values = [pair.feedback.errors[index] for pair in wrong]
    if not all(map(math.isfinite, values)):
        return text("Some values of {} are not finite", ERRORS[index])
    if index == ANGLE and _knows_position(pairs):
        causes = [it for it in causes if not it[0].endswith(POSITION_UNUSED)]
    best, least = otherwise, FITS
    for (cause, of_wrong), (_, of_all) in zip(_predictions(index, wrong, causes), _predictions(index, pairs, causes)):
        miss = _miss(index, wrong, of_wrong)
        if miss < least and _miss(index, pairs, of_all) < FITS:
            best, least = cause, miss
    cause, miss = _offset(index, pairs)
    if miss < least:
        best, least = cause, miss
    if len(set(values)) == 1 and len(values) > 5 and values[0] != 0.0 and least > EXACT:
        return text(
            "{} is always {:.2f}: recalculate it in each iteration from the newest pose", ERRORS[index], values[0]
        )
    return best


def _offset(index: int, pairs: Sequence[Pair]) -> Tuple[str, float]:
    """The cause if most values differ from the true ones by the same amount, and how much they deviate from it."""
    differences = [pair.feedback.errors[index] - pair.truth[index] for pair in pairs]
    if index == ANGLE:
        differences = [wrapped(difference - differences[0]) + differences[0] for difference in differences]
    middle = sorted(differences)[len(differences) // 2]
    spread = sorted(abs(difference - middle) for difference in differences)
    cause = text(
        "{} is always {:.2f} {} too {}", ERRORS[index], abs(middle), UNITS[index], "large" if middle > 0.0 else "small"
    )
    return cause, spread[9 * len(spread) // 10] if abs(middle) > OFFSET else math.inf


def _miss(index: int, pairs: Sequence[Pair], predicted: Sequence[float]) -> float:
    """The median difference between values and predictions; degrees and squares, which vary more, are scaled."""
    values = [pair.feedback.errors[index] for pair in pairs]
    misses = sorted(
        abs(wrapped(value - prediction) if index == ANGLE and abs(value) < 4.0 else value - prediction)
        for value, prediction in zip(values, predicted)
    )
    return misses[len(misses) // 2] / (1.0 if max(abs(value) for value in values) < 7.0 else 10.0)
