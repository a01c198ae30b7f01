"""Handle SIGINT, SIGTERM and SIGHUP once; defer them in critical sections and ignore them during cleanup."""

import os
import signal
import sys
import threading
from typing import Any, Dict, Optional, Tuple

ENDING_SIGNALS = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)
_interrupted = False


def ending_signals() -> Tuple[signal.Signals, ...]:
    """The signals that end this process; without SIGHUP under nohup, which ignores it."""
    nohup = signal.getsignal(signal.SIGHUP) is signal.SIG_IGN
    return tuple(number for number in ENDING_SIGNALS if number is not signal.SIGHUP or not nohup)


def interrupt_on_signal() -> None:
    """Have the first ending signal raise KeyboardInterrupt; later ones are ignored, so that cleanup can finish."""
    for number in ending_signals():
        signal.signal(number, _interrupt)


def _interrupt(_number: int, _frame: object) -> None:
    global _interrupted
    _interrupted = True
    threading.excepthook = lambda _: None  # threads fail when the system that they use is ended
    sys.unraisablehook = lambda _: None  # for callbacks that may raise nothing, there is reraise_if_interrupted()
    begin_cleanup()
    raise KeyboardInterrupt


def reraise_if_interrupted() -> None:
    """Raise KeyboardInterrupt again if a library swallowed it."""
    if _interrupted:
        raise KeyboardInterrupt


def begin_cleanup() -> None:
    """Ignore ending signals from now on."""
    for number in ending_signals():
        signal.signal(number, _do_nothing)


def _do_nothing(_number: int, _frame: object) -> None:
    """Unlike SIG_IGN, avoids a traceback for a signal already pending."""


def ignore_all() -> None:
    """Call last: ignore signals while Python shuts down."""
    for number in ENDING_SIGNALS:
        signal.signal(number, signal.SIG_IGN)


class Deferred:
    """A block during which some signals, or all that end a program, are deferred to its end. For the main thread.

    It replaces handlers instead of blocking the signals, because processes started in the block would inherit a mask.
    """

    def __init__(self, *numbers: int) -> None:
        self._numbers = numbers or ending_signals()
        self._handlers: Dict[int, Any] = {}
        self._number: Optional[int] = None

    @property
    def interrupted(self) -> bool:
        """Return whether a signal has arrived."""
        return self._number is not None

    def __enter__(self) -> "Deferred":
        for number in self._numbers:
            self._handlers[number] = signal.signal(number, self._defer)
        return self

    def _defer(self, number: int, _: object) -> None:
        self._number = self._number or number

    def __exit__(self, *_: object) -> None:
        for number, handler in self._handlers.items():
            signal.signal(number, handler)
        if self._number is not None:
            os.kill(os.getpid(), self._number)
