"""A class in a few figures: how many were judged, mean and median of their points; time left."""

import math
import statistics
from dataclasses import dataclass
from typing import Sequence


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


def pace(done: int, remaining: int, seconds: float) -> str:
    """The rate of grading and the time left, in words, after a number of hand-ins in a time [s, wall]."""
    if not done or not remaining or seconds <= 0.0:
        return ""
    minutes = math.ceil(remaining * seconds / done / 60.0)
    left = f"{minutes} min" if minutes < 60 else f"{minutes // 60} h {minutes % 60} min"
    return f"{60.0 * done / seconds:.1f} a minute, about {left} left"
