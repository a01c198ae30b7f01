"""Threads that wait for sockets and other files, and the bytes that are on their way to them.

The thread that answers the grader polls for all of them, and wakes those whose files are ready in one order: that in
which the grader publishes its topics, then that in which they began to wait.
"""

import _thread
import ctypes
import errno
import select
from typing import Any, Dict, List, Optional, Set, Tuple

from . import scheduler
from .scheduler import Files, Waiter

Link = Tuple[int, int]  # a TCP connection, by this process's port and the other one's
LAST = 1 << 30  # in the order, all that are no topics
select_poll = select.poll  # the system's own

grader_ports: Set[int] = set()
reading: Dict[int, Waiter] = {}  # threads that wait
received: Dict[int, "Traffic"] = {}  # by descriptor
closed: List["Traffic"] = []  # since the last answer
expected: Dict[Link, int] = {}  # bytes that the grader has sent
counts_own = True  # what the process sends to itself is waited for
_order: Dict[Link, int] = {}  # of the connections that it sends by


class _PollEntry(ctypes.Structure):
    """`struct pollfd` of poll(2)."""

    _fields_ = [("fd", ctypes.c_int), ("events", ctypes.c_short), ("revents", ctypes.c_short)]


_poll_with_gil = ctypes.PyDLL(None, use_errno=True).poll  # PyDLL does not release the interpreter's lock


class Traffic:
    """What a socket has received and sent."""

    __slots__ = ("link", "accepted", "received", "sent", "reported")

    def __init__(self, link: Optional[Link]) -> None:
        self.link = link  # of a socket that listens: its port and 0
        self.accepted = False  # by this process itself
        self.received = self.sent = self.reported = 0  # bytes


def expect(link: Link, count: int) -> None:
    """The grader has sent so many bytes by a connection so far."""
    expected[link] = count
    _order.setdefault(link, len(_order))


def _ready(files: Files) -> List[int]:
    """What is ready of each of these now, as events of poll(), without letting another thread run meanwhile."""
    entries = (_PollEntry * len(files))(*(_PollEntry(file, events) for file, events in files))
    while _poll_with_gil(entries, len(files), 0) < 0:
        if ctypes.get_errno() != errno.EINTR:  # a signal
            raise OSError(ctypes.get_errno(), "poll() of the descriptors that threads wait for")
    return [entry.revents for entry in entries]


def poll(files: Files, timeout: Optional[float] = None, receives: bool = False) -> bool:
    """Wait until one of these is ready; False if `timeout` [s, simulated] is over before.

    With `receives`, as for recv() and accept(), this also ends when another thread closes the only one.
    """
    if any(_ready(files)) or any(file < 0 for file, _ in files):  # a closed one fails at once
        return True
    me = _thread.get_ident()
    if me in scheduler.calling:
        return _poll(files, None)
    if not scheduler.active:
        return _poll(files, timeout)
    if timeout is not None and timeout <= 0.0:
        return False
    until_ns = scheduler.deadline(timeout)
    while True:
        waiter = Waiter(me, files, receives)
        with scheduler.guard:
            reading[me] = waiter
            scheduler.park(waiter, until_ns)
        try:
            scheduler.wait(waiter)
        finally:
            reading.pop(me, None)
        # Another thread may have read it meanwhile, or closed it and opened another file of this number.
        if not waiter.granted or not waiter.files or any(_ready(files)):
            return waiter.granted


def close(file: int) -> None:
    """End the waits of threads that receive from a file that is about to be closed.

    Linux ends them at shutdown(), but they have their turns when its caller has closed the file, too.
    """
    with scheduler.guard:
        for waiter in reading.values():
            if waiter.receives and not waiter.awake and waiter.files[0][0] == file:
                waiter.files, waiter.granted = [], True
                scheduler.wake(waiter)


def _poll(files: Files, timeout: Optional[float]) -> bool:
    poller = select_poll()
    for file, events in files:
        poller.register(file, events)
    return bool(poller.poll(None if timeout is None else timeout * 1e3))


# -- for the thread that answers the grader --


def wait_for(descriptor: int, timeout: Optional[float]) -> bool:
    """Wait for a descriptor of the grader's, or for files that threads wait for; whether it is the former.

    Not for topics of the grader: it sends them before a request.
    """
    with scheduler.guard:
        files = [file for file in _wanted() if not _is_topic(file[0])]
        files = [file for file, events in zip(files, _ready(files)) if not events & select.POLLNVAL]
    _poll([(descriptor, select.POLLIN), *files], timeout)
    return any(_ready([(descriptor, select.POLLIN)]))


def wait_for_more(timeout: float) -> None:
    """Wait for files that threads wait for, for `timeout` [s, wall] at most."""
    with scheduler.guard:
        files = _wanted()
    _poll(files, timeout)


def wake(topics: bool = True) -> bool:
    """Wake the threads whose files are ready, if `topics` also those of the grader's topics; whether there are any."""
    with scheduler.guard:
        files = [file for file in _wanted() if topics or not _is_topic(file[0])]
        ready = {
            file for (file, _), events in zip(files, _ready(files)) if events not in (0, select.POLLNVAL)
        }  # a closed one wakes nobody
        if not ready:
            return False
        found = []
        for waiter in reading.values():
            places = [_place(file) for file, _ in waiter.files if file in ready]
            if places and not waiter.awake:
                found.append((min(places), waiter))
        for _, waiter in sorted(found, key=lambda place_and_waiter: place_and_waiter[0]):
            waiter.granted = True
            scheduler.wake(waiter)
        return True


def more_is_expected() -> bool:
    """Return whether something is on its way to a thread that waits for it.

    On a busy machine, what a process sends to itself arrives some time later, too.
    """
    sent = dict(expected)
    connecting: Set[int] = set()  # ports of this process
    if counts_own:
        for traffic in (*closed, *received.values()):
            if traffic.link is not None:
                sent[traffic.link[::-1]] = traffic.sent
                connecting.update([] if traffic.accepted else traffic.link[1:])
    for file, _ in _wanted():
        waiting = received.get(file)
        if waiting is None or waiting.link is None:
            continue
        if waiting.received < sent.get(waiting.link, 0) or (not waiting.link[1] and waiting.link[0] in connecting):
            return True
    return False


def accept(link: Link) -> None:
    """Note that this process has accepted a connection, perhaps of its own."""
    for traffic in tuple(received.values()):
        if traffic.link == link[::-1]:
            traffic.accepted = True


def _wanted() -> Files:
    return [file for waiter in reading.values() if not waiter.awake for file in waiter.files]


def _is_topic(file: int) -> bool:
    traffic: Any = received.get(file)
    return traffic is not None and traffic.link is not None and traffic.link[1] in grader_ports


def _place(file: int) -> int:
    traffic: Any = received.get(file)
    return _order.get(traffic.link, LAST) if traffic is not None else LAST
