"""pybullet, imported without the line about its build time that its C code prints to standard error."""

import contextlib
import os
from typing import Iterator

STANDARD_ERROR = 2


@contextlib.contextmanager
def _muted() -> Iterator[None]:
    """Discard what the process prints to standard error in the block."""
    saved, nowhere = os.dup(STANDARD_ERROR), os.open(os.devnull, os.O_WRONLY)
    os.dup2(nowhere, STANDARD_ERROR)
    try:
        yield
    finally:
        os.dup2(saved, STANDARD_ERROR)
        os.close(saved)
        os.close(nowhere)


with _muted():
    import pybullet

__all__ = ["pybullet"]
