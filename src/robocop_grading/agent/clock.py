"""Python's clocks: simulated time since the node was started, on top of the time of day at its start."""

import datetime
import functools
import time
from typing import Any, Callable, Dict, List, Optional, Tuple

from .scheduler import scheduler

_real = {name: getattr(time, name) for name in ("time_ns", "monotonic_ns", "sleep")}

READS, READS_TIME = 100, 0.001  # clock reads of a thread at one simulated time, and its pause [s] after them


def note_read() -> None:
    """Note that a thread has read a clock: simulated time goes on for a loop that waits by reading a clock."""
    scheduler.spend(1.0 / READS, READS_TIME)


def time_ns() -> int:
    note_read()
    return scheduler.epoch_ns + scheduler.now_ns if scheduler.active else int(_real["time_ns"]())


def monotonic_ns() -> int:
    note_read()
    return scheduler.epoch_monotonic_ns + scheduler.now_ns if scheduler.active else int(_real["monotonic_ns"]())


def now() -> float:
    return time_ns() / 1e9


def monotonic() -> float:
    return monotonic_ns() / 1e9


def sleep(seconds: float) -> None:
    if scheduler.active and seconds > 0:
        scheduler.pause(scheduler.deadline(seconds))
    elif scheduler.active and seconds == 0:
        scheduler.yield_turn()
        note_read()  # a loop that waits in this way
    else:
        _real["sleep"](seconds)  # also complains of a negative time


class _Kind(type):
    def __instancecheck__(cls, value: object) -> bool:
        return isinstance(value, _datetime)  # also one that C code has made


_datetime = datetime.datetime


class SimulatedDatetime(_datetime, metaclass=_Kind):
    """datetime.datetime, whose now() asks the system itself; today() asks time.time()."""

    @classmethod
    def now(cls, tz: Optional[datetime.tzinfo] = None) -> "SimulatedDatetime":
        return cls.fromtimestamp(now(), tz)

    @classmethod
    def utcnow(cls) -> "SimulatedDatetime":
        return cls.utcfromtimestamp(now())


SimulatedDatetime.__name__ = SimulatedDatetime.__qualname__ = "datetime"
SimulatedDatetime.__module__ = "datetime"


def install() -> None:
    """Make all modules use these clocks, also modules that have been imported already."""
    import queue
    import socketserver
    import threading

    functions: Dict[str, Callable[..., Any]] = {
        "time": now,
        "time_ns": time_ns,
        "sleep": sleep,
        **dict.fromkeys(("monotonic", "perf_counter"), monotonic),
        **dict.fromkeys(("monotonic_ns", "perf_counter_ns"), monotonic_ns),
    }
    for name, function in functions.items():
        # As an attribute of a class a function would get `self`; this does not.
        setattr(time, name, functools.partial(function))
    dates: Any = datetime
    dates.datetime = SimulatedDatetime
    copies: List[Tuple[Any, str]] = [(threading, "_time"), (queue, "time"), (socketserver, "time")]
    for module, name in copies:
        setattr(module, name, functools.partial(monotonic))
