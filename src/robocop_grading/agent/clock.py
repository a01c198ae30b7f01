"""Python's clocks: simulated time since the node was started, on top of the time of day at its start."""

import datetime
import functools
import time
from typing import Any, Callable, Dict, List, Optional, Tuple

from .scheduler import scheduler

_real = {
    name: getattr(time, name)
    for name in "time_ns monotonic_ns sleep localtime gmtime clock_gettime_ns strftime asctime".split()
}

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


def localtime(seconds: Optional[float] = None) -> time.struct_time:
    return _real["localtime"](now() if seconds is None else seconds)


def gmtime(seconds: Optional[float] = None) -> time.struct_time:
    return _real["gmtime"](now() if seconds is None else seconds)


def clock_gettime_ns(clock: int) -> int:
    if clock == time.CLOCK_REALTIME:
        return time_ns()
    return monotonic_ns() if clock == time.CLOCK_MONOTONIC else int(_real["clock_gettime_ns"](clock))


def clock_gettime(clock: int) -> float:
    return clock_gettime_ns(clock) / 1e9


def asctime(when: Any = None) -> str:
    return str(_real["asctime"](localtime() if when is None else when))


def ctime(seconds: Optional[float] = None) -> str:
    return asctime(localtime(seconds))


def strftime(form: str, when: Any = None) -> str:
    return str(_real["strftime"](form, localtime() if when is None else when))


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
        **{"time": now, "time_ns": time_ns, "sleep": sleep, "localtime": localtime, "gmtime": gmtime},
        **{"monotonic": monotonic, "monotonic_ns": monotonic_ns},
        **{"clock_gettime": clock_gettime, "clock_gettime_ns": clock_gettime_ns},
        **{"asctime": asctime, "ctime": ctime, "strftime": strftime},
        **{"perf_counter": monotonic, "perf_counter_ns": monotonic_ns},
    }
    for name, function in functions.items():
        # As an attribute of a class, which logging makes of localtime, a function would get `self`; this does not.
        setattr(time, name, functools.partial(function))
    dates: Any = datetime
    dates.datetime = SimulatedDatetime
    copies: List[Tuple[Any, str]] = [(threading, "_time"), (queue, "time"), (socketserver, "time")]
    for module, name in copies:
        setattr(module, name, functools.partial(monotonic))
