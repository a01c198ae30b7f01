"""Lines to the process that grades, on the standard output that it reads: nothing else of this process writes there.

Libraries print there, too.
"""

import os
import sys

_descriptor = -1


def start() -> None:
    """From now on, what is printed goes to standard error, and tell() to what standard output was."""
    global _descriptor
    sys.stdout.flush()
    _descriptor = os.dup(1)
    os.dup2(2, 1)


def tell(line: str) -> None:
    """Send one line."""
    os.write(_descriptor, f"{' '.join(line.splitlines())}\n".encode())
