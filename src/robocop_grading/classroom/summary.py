"""A class in a few figures: how many were judged, mean, median and a histogram of their points; time left."""

import math
import statistics
from dataclasses import dataclass
from typing import List, Sequence, Tuple

MAX_BARS = 10  # of the histogram, besides the one for full marks
MAX_BAR = 40  # characters


@dataclass(frozen=True)
class Summary:
    """The figures of a class; points are those without extra ones, of the hand-ins that were judged."""

    points: Sequence[float]
    not_judged: int
    available: float

    @property
    def counts(self) -> str:
        """How many were judged."""
        return f"{len(self.points)} judged, {self.not_judged} not gradable"

    @property
    def averages(self) -> str:
        """Mean and median, if anybody was judged."""
        if not self.points:
            return ""
        mean, median = statistics.mean(self.points), statistics.median(self.points)
        return f"mean {mean:.2f}, median {median:g} of {self.available:g} points"

    @property
    def histogram(self) -> List[Tuple[str, int]]:
        """Ranges of points, the last one of full marks only, and the number of hand-ins in each."""
        width = max(1, math.ceil(self.available / MAX_BARS))
        edges = [*(width * number for number in range(math.ceil(self.available / width))), self.available]
        bars = []
        for low, high in zip(edges, [*edges[1:], math.inf]):
            label = f"{low:g} to < {high:g}" if high < math.inf else f"{low:g}"
            bars.append((label, sum(low <= points < high for points in self.points)))
        return bars

    def lines(self) -> List[str]:
        """All of it for a terminal."""
        highest = max([1, *(count for _, count in self.histogram)])
        bars = [
            f"{label:>10} {count:4} {'#' * math.ceil(MAX_BAR * count / highest)}".rstrip()
            for label, count in self.histogram
        ]
        return [self.counts, *([self.averages, *bars] if self.points else [])]


def pace(done: int, remaining: int, seconds: float) -> str:
    """The rate of grading and the time left, in words, after a number of hand-ins in a time [s, wall]."""
    if not done or not remaining or seconds <= 0.0:
        return ""
    minutes = math.ceil(remaining * seconds / done / 60.0)
    left = f"{minutes} min" if minutes < 60 else f"{minutes // 60} h {minutes % 60} min"
    return f"{60.0 * done / seconds:.1f} a minute, about {left} left"
