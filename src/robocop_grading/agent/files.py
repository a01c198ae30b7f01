"""Waiting for sockets and other files of the node's own: recv, accept, select, poll and epoll tell the scheduler.

The thread that answers the grader polls for all of them, and wakes those whose files are ready, in the order in which
they began to wait.
"""

import _thread
import ctypes
import errno
import functools
import select
import selectors
import socket
from typing import Any, Callable, Dict, List, Optional, Tuple

from .scheduler import SLACK, Files, Waiter, scheduler

_system_poll, _system_epoll, _system_select = select.poll, select.epoll, select.select
_reading: Dict[int, Waiter] = {}  # threads that wait


class _PollEntry(ctypes.Structure):
    """`struct pollfd` of poll(2)."""

    _fields_ = [("fd", ctypes.c_int), ("events", ctypes.c_short), ("revents", ctypes.c_short)]


_poll_with_gil = ctypes.PyDLL(None, use_errno=True).poll  # PyDLL does not release the interpreter's lock


def _ready(files: Files) -> List[int]:
    """The events of poll() that are ready for each of these files now; no other thread runs meanwhile."""
    entries = (_PollEntry * len(files))(*(_PollEntry(file, events) for file, events in files))
    while _poll_with_gil(entries, len(files), 0) < 0:
        if ctypes.get_errno() != errno.EINTR:  # a signal
            raise OSError(ctypes.get_errno(), "poll() of the descriptors that threads wait for")
    return [entry.revents for entry in entries]


def _poll(files: Files, timeout: Optional[float]) -> bool:
    poller = _system_poll()
    for file, events in files:
        poller.register(file, events)
    return bool(poller.poll(None if timeout is None else timeout * 1e3))


def wait(files: Files, timeout: Optional[float] = None) -> bool:
    """Wait until one of these files is ready; return False if `timeout` [s, simulated] is over before."""
    if any(_ready(files)) or any(file < 0 for file, _ in files):  # a closed one fails at once
        return True
    if not scheduler.active:
        return _poll(files, timeout)
    if timeout is not None and timeout <= 0.0:
        return False
    me, until_ns = _thread.get_ident(), scheduler.deadline(timeout)
    while True:
        waiter = Waiter(me, files)
        with scheduler.guard:
            _reading[me] = waiter
            scheduler.park(waiter, until_ns)
        try:
            scheduler.wait(waiter)
        finally:
            _reading.pop(me, None)
        # Another thread may have read it meanwhile, or closed it and opened another file of this number.
        if not waiter.granted or any(_ready(files)):
            return waiter.granted


# -- for the thread that answers the grader --


def wait_for_more(timeout: float) -> None:
    """Wait for files that threads wait for, for `timeout` [s, wall] at most."""
    with scheduler.guard:
        files = _wanted()
    _poll(files, timeout)


def wake() -> bool:
    """Wake the threads whose files are ready; return whether any file is ready."""
    with scheduler.guard:
        files = _wanted()
        ready = {
            file for (file, _), events in zip(files, _ready(files)) if events not in (0, select.POLLNVAL)
        }  # a closed one wakes nobody
        if ready:
            for waiter in tuple(_reading.values()):
                if not waiter.awake and any(file in ready for file, _ in waiter.files):
                    waiter.granted = True
                    scheduler.wake(waiter)
        return bool(ready)


def _wanted() -> Files:
    return [file for waiter in _reading.values() if not waiter.awake for file in waiter.files]


# -- Python's ways to wait for files --


def _await(connection: socket.socket, flags: int = 0) -> None:
    """Wait until a socket that blocks has something to read."""
    timeout = connection.gettimeout()
    if timeout != 0 and not flags & socket.MSG_DONTWAIT:
        if not wait([(connection.fileno(), select.POLLIN)], timeout):
            raise socket.timeout("timed out")


def _receiving(method: Callable[..., Any], flags_at: int) -> Callable[..., Any]:
    """A method that receives, which waits by way of the scheduler."""

    @functools.wraps(method)
    def receive(connection: socket.socket, *arguments: Any) -> Any:
        _await(connection, arguments[flags_at] if len(arguments) > flags_at else 0)
        return method(connection, *arguments)

    return receive


def _when_ready(look: Callable[[], Any], files: Files, timeout: Optional[float]) -> Any:
    """Return what `look` finds: at once, as soon as one of these files is ready, or after `timeout` [s, simulated]."""
    ready = look()
    if timeout == 0 or any(ready):
        return ready
    wait(files, None if timeout is None or timeout < 0 else timeout)
    return look()


def _descriptor(file: Any) -> int:
    return file if isinstance(file, int) else int(file.fileno())


class Poll:
    """select.poll()."""

    def __init__(self) -> None:
        self._poll = _system_poll()
        self._files: Dict[int, int] = {}
        self._empty_ns = -1  # simulated time at which nothing was ready

    def register(self, file: Any, events: int = select.POLLIN | select.POLLPRI | select.POLLOUT) -> None:
        self._poll.register(file, events)
        self._files[_descriptor(file)] = events

    def modify(self, file: Any, events: int) -> None:
        self._poll.modify(file, events)
        self._files[_descriptor(file)] = events

    def unregister(self, file: Any) -> None:
        self._poll.unregister(file)
        self._files.pop(_descriptor(file), None)

    def poll(self, timeout: Optional[float] = None) -> List[Tuple[int, int]]:
        """Wait for `timeout` [ms, simulated]. If it is 0, a second look at one simulated time lets time go on.

        multiprocessing's Connection.poll() and Queue.empty() look again and again until the clock has advanced.
        """
        seconds = None if timeout is None else timeout / 1e3
        if seconds == 0 and self._empty_ns == scheduler.now_ns:
            seconds = SLACK / 1e9
        ready = list(_when_ready(lambda: self._poll.poll(0), list(self._files.items()), seconds))
        self._empty_ns = -1 if ready else scheduler.now_ns
        return ready


class Epoll:
    """select.epoll()."""

    def __init__(self, *arguments: Any, **options: Any) -> None:
        self._epoll = _system_epoll(*arguments, **options)

    def __getattr__(self, name: str) -> Any:
        return getattr(self._epoll, name)

    def __enter__(self) -> "Epoll":
        return self

    def __exit__(self, *_: object) -> None:
        self._epoll.close()

    def poll(self, timeout: Optional[float] = None, maxevents: int = -1) -> List[Tuple[int, int]]:
        """Wait for `timeout` [s, simulated]."""
        files = [(self._epoll.fileno(), select.POLLIN)]
        return list(_when_ready(lambda: self._epoll.poll(0, maxevents), files, timeout))


def simulated_select(
    reads: Any, writes: Any, errors: Any, timeout: Optional[float] = None
) -> Tuple[List[Any], List[Any], List[Any]]:
    """select.select()."""
    given = list(reads), list(writes), list(errors)
    wanted: Dict[int, int] = {}
    for files, events in zip(given, (select.POLLIN, select.POLLOUT, select.POLLPRI)):
        for file in map(_descriptor, files):
            wanted[file] = wanted.get(file, 0) | events
    ready: Tuple[List[Any], List[Any], List[Any]] = _when_ready(
        lambda: _system_select(*given, 0), list(wanted.items()), timeout
    )
    return ready


def install() -> None:
    """Make all modules wait in this way, also modules that have been imported already."""
    cls: Any = socket.socket
    for name, flags_at in (("recv", 1), ("recv_into", 2), ("recvfrom", 1), ("recvmsg", 2)):
        setattr(cls, name, _receiving(getattr(cls, name), flags_at))
    accept = cls.accept

    @functools.wraps(accept)
    def accept_when_ready(listening: socket.socket) -> Any:
        _await(listening)
        return accept(listening)

    cls.accept = accept_when_ready
    module: Any = select
    module.poll, module.epoll, module.select = Poll, Epoll, simulated_select
    known: Any = selectors
    known.PollSelector._selector_cls, known.EpollSelector._selector_cls = Poll, Epoll
    known.SelectSelector._select = staticmethod(simulated_select)
