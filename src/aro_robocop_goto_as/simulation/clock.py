"""Simulated time in steps: stamps and due times in integer arithmetic, so that nothing drifts."""

NANOSECONDS = 1000000000


def stamp_ns(step: int, physics_rate: int) -> int:
    """Simulated time [ns] of a step at physics_rate [Hz], rounded down."""
    return step * NANOSECONDS // physics_rate


def due(step: int, rate: int, physics_rate: int) -> bool:
    """Whether something at `rate` [Hz] is due on this step: the first step at or after each multiple of its period.

    If the rate divides physics_rate the period is exact; otherwise the mean rate is exact, and each is less than
    one step late.
    """
    return (step * rate) // physics_rate != ((step - 1) * rate) // physics_rate
