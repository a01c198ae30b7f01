"""How each program of the package starts."""

import contextlib
import gc
import os
import signal
import sys
from typing import Iterator

from ..names import PACKAGE


@contextlib.contextmanager
def imports() -> Iterator[None]:
    """A block in which a program imports what it needs: fast, and Ctrl-C ends it without a traceback."""
    signal.signal(signal.SIGINT, signal.SIG_DFL)  # until main() handles it
    gc.disable()  # collections would go through all that the imports create
    yield
    gc.freeze()  # what they created is here to stay
    gc.enable()


def typed(command: str) -> str:
    """The words that start this program, for its usage: this command of ./robocop, else those for rosrun."""
    script = os.path.basename(sys.argv[0])
    return f"robocop {command}" if "ROBOCOP_STATE" in os.environ else f"rosrun {PACKAGE} {script}"
