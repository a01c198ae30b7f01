"""Which mistake explains wrong feedback: each hypothesis predicts what a server with one mistake would report."""

import math
import re
from dataclasses import replace
from statistics import mean, median
from typing import Callable, List, NamedTuple, Sequence, Set, Tuple

from aro_robocop_goto_as.geometry import Pose2D, compose

from ..record import ERRORS, Feedback, Goal, Sample, errors_at, wrapped
from ..texts import text

TOLERANCES = (0.06, 0.12)  # [m], [rad] within which a value fits a hypothesis: the default tolerances of the checks
MAX_WRONG = 0.1  # share of a scenario's values that may not fit: single ones when a turn ends
MAX_WRONG_TIME = 0.45  # [s] longest row of values that may not fit
MAX_UNEXPLAINED = 0.3  # share of all wrong values
MAX_PAIRS = 100  # of a scenario that are compared
LARGE = 7.0  # [m], [rad] larger values are squared or in degrees; the tolerances are then ten times as large
FAR = 1.0  # [m], [rad] a larger miss counts as this
SCALED = 0.2  # [m], [rad] smaller true errors are not used to estimate a factor
MAX_SPREAD = 0.1  # of such a factor
OFFSET = 0.05  # [m], [rad] a smaller constant difference counts as no difference
POSITION, ANGLE = range(2)  # indices of ERRORS
UNITS = ("m", "rad")
MAX_MEAN = 0.015  # [m], [rad] mean miss of a hypothesis; true ones have less than half of it


class Pair(NamedTuple):
    """A feedback message, the samples that it may be based on, its goal, and the sample when the goal was sent."""

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


def _misplaced(index: int) -> Sequence[Hypothesis]:
    """Poses of the goal or the robot that are mistaken for others."""
    return (
        ("goal_swapped", lambda p: errors_at(p.now, replace(p.goal, x=p.goal.y, y=p.goal.x))[index]),
        ("goal_x_missing", lambda p: errors_at(p.now, replace(p.goal, x=0.0))[index]),
        ("goal_y_missing", lambda p: errors_at(p.now, replace(p.goal, y=0.0))[index]),
        ("position_swapped", lambda p: errors_at(Pose2D(p.now.y, p.now.x, p.now.yaw), p.goal)[index]),
        ("position_x_sign", lambda p: errors_at(Pose2D(-p.now.x, p.now.y, p.now.yaw), p.goal)[index]),
        ("position_y_sign", lambda p: errors_at(Pose2D(p.now.x, -p.now.y, p.now.yaw), p.goal)[index]),
        ("pose_of_start", lambda p: errors_at(p.start, p.goal)[index]),
        ("relative", lambda p: p.misread(p.start.yaw)[index]),
        ("relative", lambda p: p.misread(0.0)[index]),
    )


FROM_ORIGIN = "angle_from_origin"
NEVER_FILLED = ("distance_zero", "angle_zero")
# Causes that explain both errors: the robot's or the goal's position is wrong.
OF_POSITION = {"distance_from_origin", FROM_ORIGIN, "position_in_world", "heading_in_world"}
OF_POSITION |= {name for name, _ in _misplaced(POSITION)}
# Causes of which the errors are those of a pose that does not change.
UNCHANGED = {"distance_from_origin", "angle_without_heading", "pose_of_start"}
POSE_TOPIC = re.compile("odom|pose|truth|position")  # in the name of a topic
CAUSES: Tuple[Sequence[Hypothesis], ...] = (
    (
        *_misplaced(POSITION),
        ("position_in_world", lambda p: math.hypot(p.goal.x - p.now.world_x, p.goal.y - p.now.world_y)),
        ("distance_from_origin", lambda p: math.hypot(p.goal.x, p.goal.y)),
        ("distance_squared", lambda p: sum(d * d for d in p.way)),
        ("distance_x_only", lambda p: abs(p.way[0])),
        ("distance_y_only", lambda p: abs(p.way[1])),
        ("distance_manhattan", lambda p: sum(abs(d) for d in p.way)),
        ("distance_larger", lambda p: max(abs(d) for d in p.way)),
        ("distance_sign", lambda p: -p.truth[POSITION]),
        ("distance_rounded", lambda p: round(p.truth[POSITION])),
        ("distance_rounded", lambda p: int(p.truth[POSITION])),
        ("distance_is_angle", lambda p: p.truth[ANGLE]),
    ),
    (
        *_misplaced(ANGLE),
        ("angle_in_degrees", lambda p: math.degrees(p.truth[ANGLE])),
        ("angle_without_sign", lambda p: abs(p.truth[ANGLE])),
        ("angle_sign", lambda p: -p.truth[ANGLE]),
        ("angle_without_heading", lambda p: p.direction),
        ("heading_without_sign", lambda p: p.direction - abs(p.now.yaw)),
        ("heading_added", lambda p: p.direction + p.now.yaw),
        ("atan2_swapped", lambda p: math.atan2(*p.way) - p.now.yaw),
        ("atan", lambda p: math.atan(p.way[1] / (p.way[0] or 1e-9)) - p.now.yaw),
        ("asin", lambda p: math.atan2(p.way[1], abs(p.way[0])) - p.now.yaw),
        ("modulo_pi", lambda p: (p.truth[ANGLE] + math.pi / 2.0) % math.pi - math.pi / 2.0),
        ("modulo_pi", lambda p: p.truth[ANGLE] % math.pi),
        ("modulo_pi", lambda p: math.fmod(p.direction - wrapped(p.now.yaw), math.pi)),
        ("direction_signs", lambda p: math.atan2(-p.way[1], p.way[0]) - p.now.yaw),
        ("direction_signs", lambda p: math.atan2(p.way[1], -p.way[0]) - p.now.yaw),
        ("direction_signs", lambda p: math.atan2(-p.way[1], -p.way[0]) - p.now.yaw),
        ("heading_from_z", lambda p: p.direction - math.sin(wrapped(p.now.yaw) / 2.0)),
        ("heading_halved", lambda p: p.direction - wrapped(p.now.yaw) / 2.0),
        (
            "heading_in_world",
            lambda p: math.atan2(p.goal.y - p.now.world_y, p.goal.x - p.now.world_x) - p.now.world_yaw,
        ),
        (FROM_ORIGIN, lambda p: math.atan2(p.goal.y, p.goal.x) - p.now.yaw),
        ("angle_rounded", lambda p: round(p.truth[ANGLE])),
        ("angle_rounded", lambda p: int(p.truth[ANGLE])),
        ("angle_is_distance", lambda p: p.truth[POSITION]),
        ("direction_once", lambda p: wrapped(errors_at(p.start, p.goal)[ANGLE] + p.start.yaw - p.now.yaw)),
    ),
)
OTHERWISE = ("position_error_wrong", "angle_error_wrong")


def likely_cause(index: int, wrong: Sequence[Pair], scenarios: Sequence[Sequence[Pair]]) -> Tuple[str, Set[str]]:
    """All causes that fit the wrong and the right values of every scenario, in words and by their names.

    If no cause fits, the text says what is wrong. `scenarios`: the pairs of each scenario, and the wrong pairs among
    them.
    """
    values = [pair.feedback.errors[index] for pairs in scenarios for pair in pairs]
    if not all(map(math.isfinite, values)):
        return f"Some values of {ERRORS[index]} are not finite", set()
    thinned = [pairs[:: 1 + len(pairs) // MAX_PAIRS] for pairs in scenarios if pairs]
    wrong = wrong[:: 1 + len(wrong) // MAX_PAIRS]
    scale = 1.0 if max(abs(value) for value in values) < LARGE else 0.1
    if len(set(values)) == 1 and len(values) > 5:
        if not any(values):
            return text(NEVER_FILLED[index]), set()
        return text("always_the_same", ERRORS[index], values[0]), set()
    names = _fitting(index, wrong, thinned, scale)
    if UNCHANGED.intersection(names) - {"pose_of_start"}:  # a special case of it
        names = [name for name in names if name != "pose_of_start"]
    return "; or: ".join(map(text, names)) or _measured(index, thinned), set(names)


def _fitting(index: int, wrong: Sequence[Pair], scenarios: Sequence[Sequence[Pair]], scale: float) -> List[str]:
    """The names of the hypotheses that fit, the best one first."""
    positions = [misses(POSITION, pairs, lambda p: p.truth[POSITION]) for pairs in scenarios]
    knows_position = all(_fits(it, POSITION, 0.5) for it in positions)
    found: List[Tuple[float, str]] = []
    for cause, predict in CAUSES[index]:
        if cause == FROM_ORIGIN and knows_position:
            continue
        if not _fits(misses(index, wrong, predict, scale), index, MAX_UNEXPLAINED):
            continue
        missed = [misses(index, pairs, predict, scale) for pairs in scenarios]
        rows = [longest(it, pairs, TOLERANCES[index]) for it, pairs in zip(missed, scenarios)]
        if max(rows) < MAX_WRONG_TIME and all(_fits(it, index) for it in missed):
            found.append((_mean(missed), cause))
    return list(dict.fromkeys(cause for miss, cause in sorted(found) if miss < MAX_MEAN))


def _measured(index: int, scenarios: Sequence[Sequence[Pair]]) -> str:
    """What is wrong with values that no hypothesis explains."""
    differences = [pair.feedback.errors[index] - pair.truth[index] for pairs in scenarios for pair in pairs]
    if index == ANGLE:
        differences = [wrapped(difference - differences[0]) + differences[0] for difference in differences]
    middle = median(differences)
    if abs(middle) > OFFSET and _fits([abs(difference - middle) for difference in differences], index):
        word = "large" if middle > 0.0 else "small"
        return f"{ERRORS[index]} is always {abs(middle):.2f} {UNITS[index]} too {word}"
    both = [it for pairs in scenarios for it in pairs if abs(it.truth[index]) > SCALED]
    factors = [it.feedback.errors[index] / it.truth[index] for it in both] or [1.0]
    factor = median(factors)
    steady = sum(abs(it - factor) > MAX_SPREAD * abs(factor) for it in factors) <= MAX_WRONG * len(factors)
    if steady and abs(factor - 1.0) > 2.0 * MAX_SPREAD:
        return f"{ERRORS[index]} is always {factor:.3g} times the true one: is its unit that of the handout?"
    return text(OTHERWISE[index])


def _fits(misses: Sequence[float], index: int, most: float = MAX_WRONG) -> bool:
    return sum(miss > TOLERANCES[index] for miss in misses) <= most * len(misses)


def longest(misses: Sequence[float], pairs: Sequence[Pair], tolerance: float) -> float:
    """The duration [s] of the longest uninterrupted row of values that do not fit."""
    longest_row, began = 0.0, math.inf
    for miss, pair in zip(misses, pairs):
        began = min(began, pair.feedback.time) if miss > tolerance else math.inf
        longest_row = max(longest_row, pair.feedback.time - began)
    return longest_row


def misses(index: int, pairs: Sequence[Pair], predict: Callable[[Pair], float], scale: float = 1.0) -> List[float]:
    """The distance of each value from the predictions for the samples that it may be based on; infinity for NaN."""
    found = []
    for pair in pairs:
        value = pair.feedback.errors[index]
        each = [value - predict(pair._replace(samples=[sample])) for sample in pair.samples]
        turns = index == ANGLE and scale == 1.0
        if turns:
            each = [wrapped(miss) for miss in each]
        between = min(each) <= 0.0 <= max(each) and not (turns and max(each) - min(each) > math.pi)
        miss = 0.0 if between else min(abs(miss) for miss in each) * scale
        found.append(miss if math.isfinite(value) else math.inf)
    return found


def _mean(scenarios: Sequence[Sequence[float]]) -> float:
    """The mean, in which a single value counts for little, however far off it is."""
    return mean(min(miss, FAR) for misses in scenarios for miss in misses)
