"""Leaves no process behind: ends every descendant of this process."""

import contextlib
import ctypes
import os
import signal
import time

PR_SET_CHILD_SUBREAPER = 36  # an option of Linux' prctl(2)
LIBC = ctypes.CDLL(None, use_errno=True)
POLL = 0.02  # [s, wall]


def adopt_orphans() -> None:
    """From now on, a descendant that loses its parent becomes a child of this process instead of init's.

    A search by process group, session or environment would miss some: the environment is empty during an exec.
    Raises OSError when the kernel refuses.
    """
    if LIBC.prctl(PR_SET_CHILD_SUBREAPER, 1, 0, 0, 0) != 0:
        raise OSError(ctypes.get_errno(), "the kernel does not let this process adopt orphans")


def reap_adopted(name: str) -> None:
    """Wait for the adopted children of a name that have ended; nobody else does, so they would stay as zombies."""
    import psutil

    for child in psutil.Process().children():
        with contextlib.suppress(psutil.NoSuchProcess, ChildProcessError):
            if child.name() == name and child.status() == psutil.STATUS_ZOMBIE:
                os.waitpid(child.pid, os.WNOHANG)


def kill_descendants() -> None:
    """Kill all children, then those they leave behind; returns when there are none. Requires adopt_orphans()."""
    import psutil  # not needed by the launcher, which starts as fast as it can

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
