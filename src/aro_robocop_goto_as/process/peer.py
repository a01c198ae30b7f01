"""The process at the other end of a TCP connection on this machine: whether it waits for a processor, or for nothing.

Time on the wall clock does not tell: on a busy machine, a process that would go on can get no processor for seconds.
"""

import contextlib
import os
import socket
import threading
from pathlib import Path
from typing import Iterator, Optional

import psutil

WANTING = "RD"  # states of a thread that runs, or waits for a processor or for a disk (proc_pid_stat(5))


class Peer:
    """Looked up when a connection takes no data; without rights to see it, or on another machine, it is unknown."""

    def __init__(self, end: socket.socket, patience: float) -> None:
        """`patience` [s]: processor time that it may use from now on before it counts as doing something else."""
        self._end = end
        self._process = _peer_of(end)
        self._limit = self._processor_time() + patience

    def wants_to_run(self) -> bool:
        """Whether it may still do what is awaited, but is kept from it; False if it is unknown."""
        if self._process is None or self._processor_time() >= self._limit:
            return False
        return any(_state(thread) in WANTING for thread in _threads(self._process.pid))

    def has_sent(self) -> bool:
        """Whether the connection has data of the other end that this process has not read yet."""
        with contextlib.suppress(OSError):
            return bool(self._end.recv(1, socket.MSG_PEEK | socket.MSG_DONTWAIT))
        return False

    def _processor_time(self) -> float:
        """[s] used by all of its threads."""
        with contextlib.suppress(psutil.Error):
            if self._process is not None:
                times = self._process.cpu_times()
                return float(times.user + times.system)
        return 0.0


def others_want_to_run() -> bool:
    """Whether a thread of this process, other than the caller's, runs or waits for a processor or a disk."""
    own = str(threading.get_native_id())
    return any(_state(thread) in WANTING for thread in _threads(os.getpid()) if thread.parent.name != own)


def _peer_of(end: socket.socket) -> Optional[psutil.Process]:
    """The process that has the other end, unless it is this one."""
    with contextlib.suppress(psutil.Error, OSError):
        ends = end.getpeername()[:2], end.getsockname()[:2]
        for connection in psutil.net_connections("tcp"):
            if (connection.laddr, connection.raddr) == ends and connection.pid not in (None, os.getpid()):
                return psutil.Process(connection.pid)
    return None


def _threads(pid: int) -> Iterator[Path]:
    return Path(f"/proc/{pid}/task").glob("*/stat")


def _state(thread: Path) -> str:
    with contextlib.suppress(OSError):  # it has ended
        return thread.read_text(errors="replace").rpartition(")")[2].split()[0]
    return "X"
