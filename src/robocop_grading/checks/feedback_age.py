"""How old the pose is from which feedback was calculated: of 0 to 3 s ago, or the same for several messages."""

import math
from typing import Sequence, Tuple

import numpy as np

from ..record import Record, SentGoal
from .feedback_hypotheses import ANGLE

AGES = np.arange(0.0, 3.005, 0.01)  # [s] of the pose that feedback may be of
MIN_AGE = 0.085  # [s] a server that waits for odometry and then for a scan is 0.07 s late; an iteration is 0.1 s
MAX_OLD = 0.4  # share of old messages; half of them are old if each value is sent twice
MIN_MOVING = 10  # fewer messages say nothing about their age
CHANGED, CHANGE_TIME = 0.02, 0.3  # [m] or [rad], [s]: the true error changes by more while the robot moves
FITS = 0.03  # [m], [rad] larger mean differences are of values that were never true
MAX_DIFFERENCE = 0.2  # [m], [rad] larger differences count as this


def age_of(records: Sequence[Record], index: int) -> float:
    """The age [s] that the values of an error reach while the robot moves; 0 if most of them are new or never true.

    A value that is sent again is as old as where it was sent first.
    """
    each = [_differences(record, goal, index) for record in records for goal in record.goals]
    differences = np.concatenate([np.zeros((0, len(AGES))), *(rows for rows, _, _ in each)])
    held = np.concatenate([np.zeros(0), *(times for _, times, _ in each)])
    moving = np.concatenate([np.zeros(0, dtype=bool), *(those for _, _, those in each)])
    if moving.sum() < MIN_MOVING:
        return 0.0
    means = differences.mean(axis=0)  # also of a robot at rest: values that are wrong there are not merely old
    best = int(means.argmin())
    if means[best] > FITS:
        return 0.0
    if AGES[best] >= MIN_AGE and means[best] <= 0.5 * means[0]:
        return float(AGES[best])
    return float(np.quantile(held[moving], 0.95)) if (held[moving] > MIN_AGE).mean() > MAX_OLD else 0.0


def _differences(record: Record, goal: SentGoal, index: int) -> Tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Of the messages about a goal: (messages, AGES) the error minus the true one so long before its value was sent
    first, how long ago [s] that was, and whether the robot moves; at rest each value is a new one.
    """
    samples = record.samples_between(goal.time - AGES[-1], record.active_until(goal))
    own = [it for it in record.feedback_of(goal) if np.isfinite(it.errors[index])]
    if len(samples) < 2 or not own:
        return np.zeros((0, len(AGES))), np.zeros(0), np.zeros(0, dtype=bool)
    values, times = np.array([it.errors[index] for it in own]), np.array([it.time for it in own])
    truth = np.array([goal.errors_at(sample)[index] for sample in samples])
    truth = np.unwrap(truth) if index == ANGLE else truth
    sampled = [sample.time for sample in samples]
    moved = np.interp(times, sampled, truth) - np.interp(times - CHANGE_TIME, sampled, truth)
    moving = np.abs(moved) > CHANGED
    runs = np.cumsum((np.diff(values, prepend=math.nan) != 0.0) | ~moving)
    first = times[np.searchsorted(runs, runs)]
    differences = values[:, None] - np.interp(first[:, None] - AGES, sampled, truth)
    if index == ANGLE:
        differences = np.remainder(differences + np.pi, 2.0 * np.pi) - np.pi
    return np.minimum(np.abs(differences), MAX_DIFFERENCE), times - first, moving
