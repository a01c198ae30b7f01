"""Whether processes have nothing left to do until a message arrives or time passes: all of their threads sleep.

Simulated time must not pass while a node still works on what it has received, subscribes to a topic, or waits for a
processor on a busy machine. A thread that waits for a processor counts as running in /proc, so the load makes the wait
longer but does not change what is seen at its end.
"""

import contextlib
import os
import threading
from typing import Dict, Iterable, List, Optional, Tuple

import psutil

BUSY = (b"R", b"D")  # states of a thread in /proc: running or runnable, waiting for a disk
SWITCHES = b"ctxt_switches:"


def tree(pids: Iterable[int]) -> List[int]:
    """Processes with all their descendants; those that have ended are left out."""
    found = []
    for pid in pids:
        with contextlib.suppress(psutil.NoSuchProcess):
            found += [pid, *(child.pid for child in psutil.Process(pid).children(recursive=True))]
    return found


def at_rest(pids: Iterable[int], polling: bool = False) -> bool:
    """Whether no thread of these processes, except the caller's own, has anything to do.

    The threads are looked at one after the other, and one may wake another meanwhile, so there are two passes: nothing
    has run between them if no thread was scheduled. `polling`: some thread looks for something every few milliseconds,
    so it is enough that all of them sleep in both passes.
    """
    mine, pids = threading.get_native_id(), list(pids)
    before = _switches(pids, mine)
    if before is None:
        return False
    after = _switches(pids, mine)
    return after is not None if polling else after == before


Thread = Tuple[int, int]  # process, thread


def _switches(pids: Iterable[int], mine: int) -> Optional[Dict[Thread, bytes]]:
    """How often each thread was scheduled, as /proc has it; None if one of them is busy."""
    threads: Dict[Thread, bytes] = {}
    for pid in pids:
        try:
            names = os.listdir(f"/proc/{pid}/task")
        except OSError:  # it has ended
            continue
        for name in names:
            if int(name) == mine:
                continue
            status = _read(f"/proc/{pid}/task/{name}/status")
            if status[status.find(b"State:") + 7 :][:1] in BUSY:
                return None
            threads[pid, int(name)] = status[status.find(SWITCHES) :]
    return threads


def _read(path: str) -> bytes:
    try:
        file = os.open(path, os.O_RDONLY)
    except OSError:  # the thread has ended
        return b""
    try:
        return os.read(file, 8192)
    except OSError:
        return b""
    finally:
        os.close(file)
