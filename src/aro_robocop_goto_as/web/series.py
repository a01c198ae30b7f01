"""The last seconds of some figures, for a plot."""

from collections import deque
from typing import Deque, Tuple

import numpy as np

SPAN = 30.0  # [s, wall] that a plot shows
MOST = 900  # samples: 30 Hz


class Series:
    """Samples of several figures at the same times; one thread may add while another one reads."""

    def __init__(self, figures: int, span: float = SPAN) -> None:
        self._figures = figures
        self._span = span
        self._samples: Deque[Tuple[float, ...]] = deque(maxlen=MOST)
        self.changed = False  # since the last call of `columns`

    def add(self, time: float, *values: float) -> None:
        """Add a sample at a time [s]."""
        if len(values) != self._figures:
            raise ValueError(f"expected {self._figures} figures, got {len(values)}")
        while self._samples and not time - self._span <= self._samples[0][0] <= time:
            self._samples.popleft()
        self._samples.append((time, *values))
        self.changed = True

    def clear(self) -> None:
        """Forget all samples."""
        self._samples.clear()
        self.changed = True

    def columns(self, now: float) -> Tuple[np.ndarray, ...]:
        """Times before `now` [s], negative, and one array for each figure; all (n,), and never empty."""
        self.changed = False
        samples = [sample for sample in list(self._samples) if now - sample[0] <= self._span]
        table = np.array(samples or [(now,) + (0.0,) * self._figures], dtype=float)
        table[:, 0] -= now
        return tuple(np.ascontiguousarray(column) for column in table.T)
