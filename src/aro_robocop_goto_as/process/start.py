"""How each program of the package starts."""

import contextlib
import gc
import signal
from typing import Iterator


@contextlib.contextmanager
def imports() -> Iterator[None]:
    """A block in which a program imports what it needs: fast, and Ctrl-C ends it without a traceback."""
    signal.signal(signal.SIGINT, signal.SIG_DFL)  # until main() handles it
    signal.pthread_sigmask(signal.SIG_UNBLOCK, [signal.SIGINT])  # ./robocop blocks it while Python starts
    gc.disable()  # collections would go through all that the imports create
    yield
    gc.freeze()  # what they created is here to stay
    gc.enable()
