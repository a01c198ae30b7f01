"""The end of a process when its parent ends, however that ends: Linux sends it a signal."""

import ctypes
import os
import signal
from typing import Callable

PR_SET_PDEATHSIG = 1  # option of Linux' prctl(2)
LIBC = ctypes.CDLL(None)  # loaded here: between fork and exec little is allowed


def end_with_parent() -> Callable[[], None]:
    """A preexec_fn for subprocess.Popen that has the child receive SIGTERM when this process ends.

    Linux sends it already when the thread ends that starts the child, so that must live as long as this process. What
    the child starts itself is not affected; that is the child's business.
    """
    parent = os.getpid()

    def between_fork_and_exec() -> None:
        LIBC.prctl(PR_SET_PDEATHSIG, signal.SIGTERM, 0, 0, 0)
        if os.getppid() != parent:  # it has ended already
            os.kill(os.getpid(), signal.SIGTERM)

    return between_fork_and_exec
