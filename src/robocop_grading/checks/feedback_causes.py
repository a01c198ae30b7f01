"""Which mistakes explain wrong feedback: those whose predicted values fit it in all scenarios."""

import math
from statistics import mean
from typing import Callable, List, Sequence, Set, Tuple

from ..handout import Limits
from ..record import ERRORS, wrapped
from .feedback_hypotheses import ANGLE, CAUSES, POSE_OF_START, Cause, Pair

# [m], [rad] within which a value fits a hypothesis
TOLERANCES = Limits().position_tolerance, Limits().angle_tolerance
MAX_WRONG = 0.1  # share of a scenario's values that may not fit: single ones when a turn ends
MAX_UNFITTED_TIME = 0.45  # [s] longest row of values that may not fit
MAX_UNEXPLAINED = 0.3  # share of all wrong values
MAX_PAIRS = 100  # of a scenario that are compared
LARGE = 7.0  # [m], [rad] larger values are squared or in degrees; the tolerances are then ten times as large
MAX_MISS = 1.0  # [m], [rad] a larger miss counts as this
UNITS = ("m", "rad")
MAX_MEAN = 0.015  # [m], [rad] mean miss of a hypothesis; true ones have less than half of it


DEFINITIONS = (
    "the distance from the position in /odom to the goal",
    "the goal's direction minus the heading, both in odom and the difference within +-pi",
)


def likely_cause(index: int, wrong: Sequence[Pair], scenarios: Sequence[Sequence[Pair]]) -> Tuple[str, Set[Cause]]:
    """All causes that fit the wrong and the right values of every scenario, and these in words.

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
            return f"{ERRORS[index]} is always zero: is it filled in?", set()
        cause = f"{ERRORS[index]} is always {values[0]:.2f}: recalculate it in each iteration from the newest pose"
        return cause, set()
    found = _fitting(index, wrong, thinned, scale)
    if any(cause.unchanged and cause.sentence != POSE_OF_START for cause in found):  # a special case of it
        found = [cause for cause in found if cause.sentence != POSE_OF_START]
    value, truth, unit = wrong[0].feedback.errors[index], wrong[0].truth[index], UNITS[index]
    seen = f"{ERRORS[index]} is {value:.2f} {unit} where it has to be {truth:.2f} {unit}, {DEFINITIONS[index]}"
    return "; or: ".join(dict.fromkeys(cause.sentence for cause in found)) or seen, set(found)


def _fitting(index: int, wrong: Sequence[Pair], scenarios: Sequence[Sequence[Pair]], scale: float) -> List[Cause]:
    """The causes that fit, the best one first."""
    found: List[Tuple[float, Cause]] = []
    for cause in CAUSES:
        predict = cause.formula
        if cause.of != index or not _fits(misses(index, wrong, predict, scale), index, MAX_UNEXPLAINED):
            continue
        missed = [misses(index, pairs, predict, scale) for pairs in scenarios]
        rows = [longest(it, pairs, TOLERANCES[index]) for it, pairs in zip(missed, scenarios)]
        if max(rows) < MAX_UNFITTED_TIME and all(_fits(it, index) for it in missed) and _mean(missed) < MAX_MEAN:
            found.append((_mean(missed), cause))
    return [cause for _, cause in sorted(found, key=lambda it: it[0])]


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
    return mean(min(miss, MAX_MISS) for misses in scenarios for miss in misses)
