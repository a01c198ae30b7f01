"""Ending every descendant of this process, whatever process group or session it is in."""

import contextlib
import ctypes
import os
import signal
import time

import psutil

PR_SET_CHILD_SUBREAPER = 36  # option of Linux' prctl(2)
POLL = 0.02  # [s, wall]


def adopt_orphans() -> None:
    """From now on, a descendant that loses its parent becomes a child of this process instead of init's.

    A search by process group, session or environment would miss some: the environment is empty during an exec.
    Raises OSError when the kernel refuses.
    """
    if ctypes.CDLL(None, use_errno=True).prctl(PR_SET_CHILD_SUBREAPER, 1, 0, 0, 0) != 0:
        raise OSError(ctypes.get_errno(), "the kernel does not let this process adopt orphans")


def kill_descendants() -> None:
    """Kill all children, then those they leave behind; returns when there are none. Requires adopt_orphans()."""
    while True:
        for child in psutil.Process().children():
            with contextlib.suppress(psutil.NoSuchProcess):
                child.send_signal(signal.SIGKILL)
        try:
            while os.waitpid(-1, os.WNOHANG) != (0, 0):
                pass
        except ChildProcessError:
            return
        time.sleep(POLL)
