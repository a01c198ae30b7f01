"""Figures over time, for a plot: of the last seconds, or of a whole recording."""

from typing import Tuple

import numpy as np

Samples = Tuple[Tuple[float, ...], ...]  # each the time [s] and one or more figures
SPAN = 30.0  # [s, wall] that a plot shows
MOST = 900  # samples: 30 Hz


def extended(samples: Samples, time: float, *figures: float) -> Samples:
    """The samples of the last seconds and a new one at a time [s]; none from after that time."""
    kept = (sample for sample in samples[1 - MOST :] if time - SPAN <= sample[0] <= time)
    return (*kept, (time, *figures))


def columns(samples: Samples, figures: int, now: float) -> Tuple[np.ndarray, ...]:
    """Times before `now` [s], negative, and one array for each figure; all (n,), and never empty."""
    recent = [sample for sample in samples if now - sample[0] <= SPAN]
    table = np.array(recent or [(now,) + (0.0,) * figures], dtype=float)
    table[:, 0] -= now
    return tuple(np.ascontiguousarray(column) for column in table.T)


def held(samples: Samples, times: np.ndarray, figures: int) -> Tuple[np.ndarray, ...]:
    """Each figure at these times (n,) [s]: its newest value, 0 before the first one."""
    table = np.array([(-np.inf,) + (0.0,) * figures, *samples])
    newest = np.searchsorted(table[:, 0], times, side="right") - 1
    return tuple(np.ascontiguousarray(column) for column in table[newest, 1:].T)
