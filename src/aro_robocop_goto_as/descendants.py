"""Ends all that this process has started, and what that has started, in whatever group or session it runs."""

import contextlib
import ctypes
import os
import signal
import time
from pathlib import Path
from typing import List

ADOPT = 36  # PR_SET_CHILD_SUBREAPER of Linux' prctl(2)
POLL = 0.02  # [s, wall]


def adopt() -> None:
    """From now on, a descendant of this process that loses its parent is a child of this process, and not of init.

    So nothing gets lost, as it does for who looks for groups, sessions or a mark in the environment, which is empty
    while a program is being exec'd. Raises OSError where the kernel refuses.
    """
    if ctypes.CDLL(None, use_errno=True).prctl(ADOPT, 1, 0, 0, 0) != 0:
        raise OSError(ctypes.get_errno(), "the kernel does not let this process adopt its orphans")


def kill() -> None:
    """Kill the children, and those that they leave behind; returns when none is left."""
    while True:
        for child in _children():
            with contextlib.suppress(ProcessLookupError):
                os.kill(child, signal.SIGKILL)
        try:
            while os.waitpid(-1, os.WNOHANG) != (0, 0):
                pass
        except ChildProcessError:
            return
        time.sleep(POLL)


def _children() -> List[int]:
    found = []
    for stat in Path("/proc").glob("[0-9]*/stat"):
        with contextlib.suppress(OSError):  # ended meanwhile
            # "pid (name) state parent ...", where the name may hold anything, parentheses too
            if int(stat.read_text(errors="replace").rpartition(")")[2].split()[1]) == os.getpid():
                found.append(int(stat.parent.name))
    return found
