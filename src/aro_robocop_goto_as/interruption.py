"""Keeps the signals that end a program away from what must not be interrupted halfway."""

import os
import signal
from typing import Any, Dict, Optional, Tuple

ENDING_SIGNALS = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)
_came = False  # a signal, to a program that takes them as Ctrl-C


def heeded() -> Tuple[signal.Signals, ...]:
    """Those of them that this process has to heed: not SIGHUP where nohup has it ignored."""
    nohup = signal.getsignal(signal.SIGHUP) is signal.SIG_IGN
    return tuple(number for number in ENDING_SIGNALS if number is not signal.SIGHUP or not nohup)


def as_ctrl_c() -> None:
    """The first of these signals raises KeyboardInterrupt, so that what was begun is cleaned up; more don't disturb it.

    For programs whose cleaning up is a matter of seconds.
    """
    for number in heeded():
        signal.signal(number, _interrupt)


def the_end() -> None:
    """The last line of a program, whose exit status is settled: Python itself ends with the signals' defaults."""
    for number in ENDING_SIGNALS:
        signal.signal(number, signal.SIG_IGN)


def _interrupt(_number: int, _frame: object) -> None:
    global _came
    _came = True
    clean_up()
    raise KeyboardInterrupt


def clean_up() -> None:
    """What follows has to be done in any case: signals change nothing any more."""
    for number in heeded():
        signal.signal(number, _too_late)


def _too_late(_number: int, _frame: object) -> None:
    """Not SIG_IGN: of a signal that has come already, but waits for its handler, Python would print a traceback."""


def check() -> None:
    """Raise KeyboardInterrupt once more, after a call of what may have taken the first one for a failure of its own."""
    if _came:
        raise KeyboardInterrupt


class Deferred:
    """A block whose end such a signal waits for. For the main thread, and for blocks that come to an end.

    Handlers, and not the signal mask, do this: processes that are started in the block would inherit the mask.
    """

    def __init__(self) -> None:
        self._handlers: Dict[int, Any] = {}
        self._came: Optional[int] = None

    def __enter__(self) -> None:
        for number in heeded():
            self._handlers[number] = signal.signal(number, self._later)

    def _later(self, number: int, _: object) -> None:
        self._came = self._came or number

    def __exit__(self, *_: object) -> None:
        for number, handler in self._handlers.items():
            signal.signal(number, handler)
        if self._came is not None:
            os.kill(os.getpid(), self._came)
