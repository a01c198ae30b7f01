"""Keeps the signals that end a program away from what must not be interrupted halfway."""

import os
import signal
from typing import Any, Dict, List

ENDING_SIGNALS = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)


def as_ctrl_c() -> None:
    """All of these signals raise KeyboardInterrupt: what was begun is cleaned up, whoever ends the program."""
    for number in ENDING_SIGNALS:
        signal.signal(number, signal.default_int_handler)


class Deferred:
    """A block whose end such a signal waits for, unless a second one comes. For the main thread.

    Handlers, and not the signal mask, do this: processes that are started in the block would inherit the mask.
    """

    def __init__(self) -> None:
        self._handlers: Dict[int, Any] = {}
        self._came: List[int] = []

    def __enter__(self) -> None:
        for number in ENDING_SIGNALS:
            self._handlers[number] = signal.signal(number, self._later)

    def __exit__(self, *_: object) -> None:
        self._give_back()

    def _later(self, number: int, _: object) -> None:
        self._came.append(number)
        if len(self._came) > 1:
            self._give_back()

    def _give_back(self) -> None:
        while self._handlers:
            signal.signal(*self._handlers.popitem())
        while self._came:
            os.kill(os.getpid(), self._came.pop())
