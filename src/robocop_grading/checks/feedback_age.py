"""How old the pose is from which feedback was calculated, and whether feedback is calculated anew for each message."""

from typing import Optional, Sequence

import numpy as np

from ..record import Record, SentGoal
from .feedback_hypotheses import ANGLE, Pair

AGES = np.arange(0.0, 0.305, 0.01)  # [s] of the pose that feedback may be of
LONG_AGES = np.arange(0.0, 3.05, 0.1)  # [s] likewise, of feedback that is wrong
OLD = 0.085  # [s] a server that waits for odometry and then for a scan is 0.07 s late; an iteration is 0.1 s
MOVING = 10  # fewer messages say nothing about their age
CHANGED = 0.02  # [m], [rad] change of an error within the oldest of the ages
STEP = 0.005  # [m], [rad] change of an error from one message to the next
MAX_DIFFERENCE = 0.2  # [m], [rad] that counts of a difference
MOST = 0.6  # share of messages that have the value of the one before


def age_of(records: Sequence[Record], index: int, ages: np.ndarray) -> Optional[float]:
    """The age [s] of the pose with which an error fits clearly better than with the present pose, if there is one."""
    rows = [_differences(record, goal, index, ages) for record in records for goal in record.goals]
    differences = np.concatenate([np.zeros((0, len(ages))), *rows])
    if len(differences) < MOVING:
        return None
    means = differences.mean(axis=0)
    best = int(means.argmin())
    return None if ages[best] < OLD or means[best] > 0.5 * means[0] else float(ages[best])


def repeats(index: int, scenarios: Sequence[Sequence[Pair]]) -> int:
    """How many messages in a row have the same value although the true error changes; 0 if most values are new."""
    moving = same = 0
    for pairs in scenarios:
        for before, pair in zip(pairs, pairs[1:]):
            if pair.goal == before.goal and abs(pair.truth[index] - before.truth[index]) > STEP:
                moving += 1
                same += pair.feedback.errors[index] == before.feedback.errors[index]
    return round(moving / (moving - same)) if moving > MOVING and MOST * moving < same < moving else 0


def _differences(record: Record, goal: SentGoal, index: int, ages: np.ndarray) -> np.ndarray:
    """For each message while the true error changes, and each of the ages, the difference from the error of then."""
    samples = record.samples_between(goal.time - ages[-1] - 0.2, record.active_until(goal))
    own = record.feedback_of(goal)
    if len(samples) < 2 or not own:
        return np.zeros((0, len(ages)))
    values = np.array([message.errors[index] for message in own])
    truth = np.array([goal.errors_at(sample)[index] for sample in samples])
    truth = np.unwrap(truth) if index == ANGLE else truth
    sampled = [sample.time for sample in samples]
    times = np.array([message.time for message in own])
    then = np.array([np.interp(times - age, sampled, truth) for age in ages]).T
    differences = values[:, None] - then
    if index == ANGLE:
        differences = np.remainder(differences + np.pi, 2.0 * np.pi) - np.pi
    moving = np.abs(then[:, 0] - then[:, -1]) > CHANGED
    return np.minimum(np.abs(differences), MAX_DIFFERENCE)[moving & np.isfinite(values)]
