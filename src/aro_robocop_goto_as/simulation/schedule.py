"""The steps on which sensors and ticks are due, in integer arithmetic, so that nothing drifts."""

from typing import List, Mapping, Tuple

from ..geometry import NANOSECONDS

CLOCK, CONTROL = "clock", "control"  # the ticks


def stamp_ns(step: int, physics_rate: int) -> int:
    """Simulated time [ns] of a step at physics_rate [Hz], rounded down."""
    return step * NANOSECONDS // physics_rate


def due(step: int, rate: int, physics_rate: int) -> bool:
    """Return whether something at `rate` [Hz] is due on this step, the first one at or after a multiple of its period.

    If the rate divides physics_rate the period is exact. Otherwise the mean rate is exact, and each time is less than
    one step late.
    """
    return (step * rate) // physics_rate != ((step - 1) * rate) // physics_rate


def due_next(rates: Mapping[str, int], physics_rate: int) -> List[Tuple[int, Tuple[str, ...]]]:
    """How many steps after each step of a second something is due, and what it is, in the order of the rates.

    `rates` [Hz] by the names of what is due; 0: never. One of them at least must divide physics_rate. Every second is
    alike, as all rates are whole numbers.
    """
    names = [
        tuple(name for name, rate in rates.items() if rate and due(step, rate, physics_rate))
        for step in range(1, physics_rate + 1)
    ]
    steps, following = 0, names[-1]
    after: List[Tuple[int, Tuple[str, ...]]] = []
    for due_now in reversed(names):
        steps, following = (1, due_now) if due_now else (steps + 1, following)
        after.append((steps, following))
    return after[::-1]
