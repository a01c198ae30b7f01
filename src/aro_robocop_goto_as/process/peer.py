"""Whether this process, or the one at the other end of a TCP connection, waits for a processor, or for nothing.

Time on the wall clock does not tell: on a busy machine, a process that would go on can get no processor for seconds.
"""

import functools
import os
import socket
import threading
import time
from contextlib import suppress
from typing import Any, Dict, List, Optional, Tuple

WANTING = (["R"], ["D"])  # states of a thread that runs, or waits for a processor or for a disk
TICK = os.sysconf("SC_CLK_TCK")  # [1/s] of processor times


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
        return _want_to_run(self._process)

    def has_sent(self) -> bool:
        """Whether the connection has data of the other end that this process has not read yet."""
        with suppress(OSError):
            return bool(self._end.recv(1, socket.MSG_PEEK | socket.MSG_DONTWAIT))
        return False

    def _processor_time(self) -> float:
        """[s] used by all of its threads; 0 if it is unknown or gone."""
        words = _stat(f"/proc/{self._process}/stat")
        return (int(words[11]) + int(words[12])) / TICK if len(words) > 12 else 0.0


def others_want_to_run() -> bool:
    """Whether a thread of this process, other than the caller's, runs or waits for a processor or a disk."""
    return _want_to_run(os.getpid(), but=threading.get_native_id())


def _peer_of(end: socket.socket) -> Optional[int]:
    """The id of the process that has the other end, unless it is this one."""
    with suppress(OSError):
        owner = _owners(int(time.monotonic())).get((end.getpeername()[:2], end.getsockname()[:2]))
        return None if owner == os.getpid() else owner
    return None


@functools.lru_cache(maxsize=1)
def _owners(_second: int) -> Dict[Tuple[Any, ...], int]:
    """Processes by their connections' own and other addresses, read once a second: a stopped node can have hundreds."""
    import psutil  # seldom needed: not at the start of a node

    with suppress(psutil.Error, OSError):
        connections = psutil.net_connections("tcp")
        return {(tuple(one.laddr), tuple(one.raddr)): int(one.pid) for one in connections if one.pid is not None}
    return {}


def _want_to_run(process: int, but: int = 0) -> bool:
    """Whether one of a process's threads, `but` this one, runs or is kept from it."""
    with suppress(OSError):  # the process has ended
        threads = [thread for thread in os.listdir(f"/proc/{process}/task") if thread != str(but)]
        return any(_stat(f"/proc/{process}/task/{thread}/stat")[:1] in WANTING for thread in threads)
    return False


def _stat(path: str) -> List[str]:
    """The words from a thread's or process's state on (proc_pid_stat(5)); none if it has ended."""
    with suppress(OSError), open(path, errors="replace") as file:
        return file.read().rpartition(")")[2].split()
    return []
