"""Sends lines to the process that grades, which reads this process's standard output.

Libraries print there, too, so their output goes to standard error instead.
"""

import os
import sys

_descriptor = -1


def start() -> None:
    """From now on, print() writes to standard error, and tell() writes to the former standard output."""
    global _descriptor
    sys.stdout.flush()
    _descriptor = os.dup(1)
    os.dup2(2, 1)


def tell(line: str) -> None:
    """Send one line."""
    os.write(_descriptor, f"{' '.join(line.splitlines())}\n".encode())
