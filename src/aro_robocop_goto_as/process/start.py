"""How each program of the package starts."""

import contextlib
import gc
import os
import signal
import sys
from typing import Iterator

from ..names import PACKAGE

BY_ROBOCOP = "ROBOCOP_STARTS_A_SCRIPT"  # environment variable, set by ./robocop for the script that it becomes


@contextlib.contextmanager
def imports() -> Iterator[None]:
    """A block in which a program imports what it needs: fast, and Ctrl-C ends it without a traceback."""
    signal.signal(signal.SIGINT, signal.SIG_DFL)  # until main() handles it
    signal.pthread_sigmask(signal.SIG_UNBLOCK, [signal.SIGINT])  # ./robocop blocks it while Python starts
    gc.disable()  # collections would go through all that the imports create
    yield
    gc.freeze()  # what they created is here to stay
    gc.enable()


def typed(command: str) -> str:
    """The words that started this program, for its usage: this command of ./robocop, else those for rosrun.

    Call it once: it removes the variable, so that child programs do not inherit it.
    """
    script = os.path.basename(sys.argv[0])
    return f"robocop {command}" if os.environ.pop(BY_ROBOCOP, "") else f"rosrun {PACKAGE} {script}"
