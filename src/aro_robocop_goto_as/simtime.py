"""Simulated time in whole steps: stamps and schedules by whole-number arithmetic, so that nothing drifts."""

NANOSECONDS = 1000000000


def stamp_ns(step: int, physics_rate: int) -> int:
    """Simulated time [ns] of a step at physics_rate [Hz], rounded down."""
    return step * NANOSECONDS // physics_rate


def due(step: int, rate: int, physics_rate: int) -> bool:
    """Whether something at `rate` [Hz] happens on this step: the first one at or after each multiple of its period.

    Where the rate divides physics_rate the period is exact; otherwise the mean rate is, and no stamp is more than one
    step late.
    """
    return (step * rate) // physics_rate != ((step - 1) * rate) // physics_rate
