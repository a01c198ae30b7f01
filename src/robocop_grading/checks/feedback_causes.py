"""Which mistake explains wrong values of the feedback: hypotheses that predict what a server would report with it."""

import math
from dataclasses import replace
from statistics import mean, median
from typing import Callable, List, NamedTuple, Sequence, Tuple

from aro_robocop_goto_as.geometry import Pose2D, compose

from ..record import ERRORS, Feedback, Goal, Sample, errors_at, wrapped
from ..texts import text

FITS = 0.1  # [m], [rad] largest median error of a hypothesis
FAR = 1.0  # [m], [rad] that a miss counts at most
OFFSET = 0.05  # [m], [rad] a smaller constant difference is none
POSITION, ANGLE = range(2)  # indices of ERRORS
UNITS = ("m", "rad")
EXACT = 0.003  # [m], [rad] a hypothesis that fits better than this explains a constant value; less is no difference


class Pair(NamedTuple):
    """A feedback message, the samples that it may be based on, its goal, and where the robot was when that was sent."""

    feedback: Feedback
    samples: List[Sample]
    goal: Goal
    start: Sample

    @property
    def now(self) -> Sample:
        """The newest sample."""
        return self.samples[-1]

    @property
    def truth(self) -> Tuple[float, float]:
        """Both true errors."""
        return errors_at(self.now, self.goal)

    @property
    def way(self) -> Tuple[float, float]:
        """From the robot to the goal, in odom [m]."""
        return self.goal.x - self.now.x, self.goal.y - self.now.y

    @property
    def direction(self) -> float:
        """The goal's direction in odom [rad]."""
        return math.atan2(self.way[1], self.way[0])

    def misread(self, yaw: float) -> Tuple[float, float]:
        """Both errors for a goal that is taken relative to the robot, in a frame turned by `yaw`, when it was sent."""
        there = compose(Pose2D(self.start.x, self.start.y, yaw), Pose2D(self.goal.x, self.goal.y))
        return errors_at(self.now, replace(self.goal, x=there.x, y=there.y))


Hypothesis = Tuple[str, Callable[[Pair], float]]  # name of the cause's text; the value that it would lead to
FROM_ORIGIN = "angle_from_origin"
NEVER_FILLED = {"distance_zero", "angle_zero"}
# Causes that explain both errors: the robot's or the goal's position is wrong.
OF_POSITION = {"relative", "distance_from_origin", FROM_ORIGIN, "position_in_world", "heading_in_world"}
CAUSES: Tuple[Sequence[Hypothesis], ...] = (
    (
        ("position_in_world", lambda p: math.hypot(p.goal.x - p.now.world_x, p.goal.y - p.now.world_y)),
        ("distance_from_origin", lambda p: math.hypot(p.goal.x, p.goal.y)),
        ("distance_squared", lambda p: sum(d * d for d in p.way)),
        ("distance_x_only", lambda p: abs(p.way[0])),
        ("distance_y_only", lambda p: abs(p.way[1])),
        ("distance_manhattan", lambda p: sum(abs(d) for d in p.way)),
        ("distance_sign", lambda p: -p.truth[POSITION]),
        ("distance_zero", lambda p: 0.0),
        ("distance_is_angle", lambda p: p.truth[ANGLE]),
        ("relative", lambda p: p.misread(p.start.yaw)[POSITION]),
        ("relative", lambda p: p.misread(0.0)[POSITION]),
    ),
    (
        ("angle_in_degrees", lambda p: math.degrees(p.truth[ANGLE])),
        # What has no sign comes before a wrong sign, which is as likely on the right, but is found on the left.
        ("angle_without_sign", lambda p: abs(p.truth[ANGLE])),
        ("angle_sign", lambda p: -p.truth[ANGLE]),
        ("angle_without_heading", lambda p: p.direction),
        ("heading_without_sign", lambda p: p.direction - abs(p.now.yaw)),
        ("heading_added", lambda p: p.direction + p.now.yaw),
        ("atan2_swapped", lambda p: math.atan2(*p.way) - p.now.yaw),
        # Before two wrong signs, which are the same for goals behind, but are found with the first goal, ahead.
        ("atan", lambda p: math.atan(p.way[1] / (p.way[0] or 1e-9)) - p.now.yaw),
        ("direction_signs", lambda p: math.atan2(-p.way[1], p.way[0]) - p.now.yaw),
        ("direction_signs", lambda p: math.atan2(p.way[1], -p.way[0]) - p.now.yaw),
        ("direction_signs", lambda p: math.atan2(-p.way[1], -p.way[0]) - p.now.yaw),
        ("heading_from_z", lambda p: p.direction - math.sin(p.now.yaw / 2.0)),
        (
            "heading_in_world",
            lambda p: math.atan2(p.goal.y - p.now.world_y, p.goal.x - p.now.world_x) - p.now.world_yaw,
        ),
        (FROM_ORIGIN, lambda p: math.atan2(p.goal.y, p.goal.x) - p.now.yaw),
        ("angle_zero", lambda p: 0.0),
        ("angle_is_distance", lambda p: p.truth[POSITION]),
        ("direction_once", lambda p: wrapped(errors_at(p.start, p.goal)[ANGLE] + p.start.yaw - p.now.yaw)),
        ("relative", lambda p: p.misread(p.start.yaw)[ANGLE]),
        ("relative", lambda p: p.misread(0.0)[ANGLE]),
    ),
)
OTHERWISE = ("position_error_wrong", "angle_error_wrong")


def likely_cause(index: int, wrong: Sequence[Pair], pairs: Sequence[Pair]) -> str:
    """The hypothesis that fits all values best, of those that fit most of the wrong ones and most of all.

    A few wrong values fit many hypotheses, which the right ones then contradict. `wrong` are among `pairs`.
    """
    values = [pair.feedback.errors[index] for pair in wrong]
    if not all(map(math.isfinite, values)):
        return text("Some values of {} are not finite", ERRORS[index])
    knows_position = median(_misses(POSITION, pairs, lambda pair: pair.truth[POSITION])) < FITS
    are_wrong = set(map(id, wrong))
    best, least = text(OTHERWISE[index]), math.inf
    for cause, predict in CAUSES[index]:
        impossible = knows_position if cause == FROM_ORIGIN else cause in NEVER_FILLED and any(values)
        misses = _misses(index, pairs, predict)
        of_wrong = [miss for pair, miss in zip(pairs, misses) if id(pair) in are_wrong]
        if impossible or median(misses) >= FITS or median(of_wrong) >= FITS:
            continue
        miss = _mean(misses)
        if miss < least - EXACT:
            best, least = text(cause), miss
    offset, misses = _offset(index, pairs)
    if misses[9 * len(misses) // 10] < FITS and _mean(misses) < least - EXACT:
        best, least = offset, _mean(misses)
    if len(set(values)) == 1 and len(values) > 5 and values[0] != 0.0 and least > EXACT:
        return text("always_the_same", ERRORS[index], values[0])
    return best


def _offset(index: int, pairs: Sequence[Pair]) -> Tuple[str, List[float]]:
    """The cause if most values differ from the true ones by the same amount; deviations from it, the smallest first."""
    differences = [pair.feedback.errors[index] - pair.truth[index] for pair in pairs]
    if index == ANGLE:
        differences = [wrapped(difference - differences[0]) + differences[0] for difference in differences]
    middle = sorted(differences)[len(differences) // 2]
    word = "large" if middle > 0.0 else "small"
    cause = text("{} is always {:.2f} {} too {}", ERRORS[index], abs(middle), UNITS[index], word)
    if abs(middle) <= OFFSET:
        return cause, [math.inf]
    return cause, sorted(abs(difference - middle) for difference in differences)


def _misses(index: int, pairs: Sequence[Pair], predict: Callable[[Pair], float]) -> List[float]:
    """Differences between values and predictions; of degrees and squares, which vary more, a tenth."""
    values = [pair.feedback.errors[index] for pair in pairs]
    misses = [value - predict(pair) for value, pair in zip(values, pairs)]
    if index == ANGLE:
        misses = [wrapped(miss) if abs(value) < 4.0 else miss for value, miss in zip(values, misses)]
    scale = 1.0 if max(abs(value) for value in values) < 7.0 else 0.1
    return [abs(miss) * scale for miss in misses]


def _mean(misses: Sequence[float]) -> float:
    """The mean, in which a single value counts for little, however far off it is."""
    return mean(min(miss, FAR) for miss in misses)
