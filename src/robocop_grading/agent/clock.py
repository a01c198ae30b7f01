"""Python's clocks: simulated time since the node was started, on top of the true time at its start."""

import functools
import time
from typing import Any, Callable, List, Optional, Tuple

from . import scheduler

_real = {
    name: getattr(time, name) for name in ("time_ns", "monotonic_ns", "sleep", "localtime", "gmtime", "clock_gettime")
}


def time_ns() -> int:
    return scheduler.epoch_ns + scheduler.now_ns if scheduler.active else int(_real["time_ns"]())


def monotonic_ns() -> int:
    return scheduler.epoch_monotonic_ns + scheduler.now_ns if scheduler.active else int(_real["monotonic_ns"]())


def now() -> float:
    return time_ns() / 1e9


def monotonic() -> float:
    return monotonic_ns() / 1e9


def sleep(seconds: float) -> None:
    if not scheduler.active:
        _real["sleep"](seconds)
    elif seconds < 0:
        raise ValueError("sleep length must be non-negative")
    elif seconds > 0:
        scheduler.pause(scheduler.deadline(seconds))
    else:
        _real["sleep"](0)


def localtime(seconds: Optional[float] = None) -> time.struct_time:
    return _real["localtime"](now() if seconds is None else seconds)


def gmtime(seconds: Optional[float] = None) -> time.struct_time:
    return _real["gmtime"](now() if seconds is None else seconds)


def clock_gettime(clock: int) -> float:
    if clock == time.CLOCK_REALTIME:
        return now()
    return monotonic() if clock == time.CLOCK_MONOTONIC else float(_real["clock_gettime"](clock))


def install() -> None:
    """Have everything use these clocks, also modules that have been imported already."""
    import queue
    import socketserver
    import threading

    replacements: List[Tuple[Any, str, Callable[..., Any]]] = [
        (time, "time", now),
        (time, "time_ns", time_ns),
        (time, "monotonic", monotonic),
        (time, "monotonic_ns", monotonic_ns),
        (time, "perf_counter", monotonic),
        (time, "perf_counter_ns", monotonic_ns),
        (time, "clock_gettime", clock_gettime),
        (time, "sleep", sleep),
        (time, "localtime", localtime),
        (time, "gmtime", gmtime),
        (threading, "_time", monotonic),
        (queue, "time", monotonic),
        (socketserver, "time", monotonic),
    ]
    for module, name, function in replacements:
        # As an attribute of a class, which logging makes of localtime, a function would get `self`; this does not.
        setattr(module, name, functools.partial(function))
