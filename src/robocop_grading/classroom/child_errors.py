"""Keeps what child processes write to standard error out of the terminal."""

import os
import sys
from pathlib import Path


def send_child_errors_to(log: Path) -> None:
    """Redirect the standard error of future child processes, but not of this one, to `log` (overwritten).

    For libraries that start processes themselves: interrupted, those of dask and multiprocessing print tracebacks.
    """
    sys.stderr.flush()
    terminal = os.dup(2)  # not inherited
    sys.stderr = open(terminal, "w", buffering=1, encoding=sys.stderr.encoding, errors="backslashreplace")
    with open(log, "wb") as file:
        os.dup2(file.fileno(), 2)
