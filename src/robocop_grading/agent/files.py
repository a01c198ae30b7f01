"""Waiting for sockets and other files: recv, accept, select, poll and epoll tell the scheduler, and count bytes."""

import _thread
import functools
import select
import selectors
import socket
from typing import Any, Callable, Dict, List, Optional, Tuple

from . import readers, scheduler
from .readers import Traffic
from .scheduler import Files


def traffic_of(connection: socket.socket) -> Traffic:
    """The counts of a socket."""
    file = connection.fileno()
    traffic = readers.received.get(file)
    if traffic is None or traffic.link is None:
        link = None
        if connection.family in (socket.AF_INET, socket.AF_INET6) and connection.type == socket.SOCK_STREAM:
            try:
                link = connection.getsockname()[1], connection.getpeername()[1]
            except OSError:  # it is not connected yet
                pass
        if traffic is None:
            traffic = readers.received[file] = Traffic(link)
        if link is not None:
            readers.expected.pop(link, None)  # of an earlier connection with the same ports
        traffic.link = link
    return traffic


def _forget(connection: socket.socket) -> None:
    """The socket is closed, but the grader still has to read what was sent."""
    traffic = readers.received.pop(connection.fileno(), None)
    if traffic is not None:
        readers.closed.append(traffic)


def _await(connection: socket.socket, flags: int = 0) -> None:
    """Wait until a socket that blocks has something to read."""
    timeout = connection.gettimeout()
    if timeout != 0 and not flags & socket.MSG_DONTWAIT:
        if not readers.poll([(connection.fileno(), select.POLLIN)], timeout, receives=True):
            raise socket.timeout("timed out")


def _receiving(method: Callable[..., Any], size: Callable[[Any], int], flags_at: int) -> Callable[..., Any]:
    """A method that receives, which waits by way of the scheduler."""

    @functools.wraps(method)
    def receive(connection: socket.socket, *arguments: Any) -> Any:
        flags = arguments[flags_at] if len(arguments) > flags_at else 0
        traffic = traffic_of(connection)
        _await(connection, flags)
        result = method(connection, *arguments)
        if not flags & socket.MSG_PEEK:
            traffic.received += size(result)
        return result

    return receive


def _sending(method: Callable[..., Any]) -> Callable[..., Any]:
    @functools.wraps(method)
    def send(connection: socket.socket, data: Any, *arguments: Any) -> Any:
        traffic = traffic_of(connection)
        result = method(connection, data, *arguments)
        traffic.sent += memoryview(data).nbytes if result is None else result
        return result

    return send


def _when_ready(look: Callable[[], Any], files: Files, timeout: Optional[float]) -> Any:
    """What `look` finds at once, or after `timeout` [s, simulated], or as soon as one of these files is ready."""
    ready = look()
    if timeout == 0 or any(ready):
        return ready
    readers.poll(files, None if timeout is None or timeout < 0 else timeout)
    return look()


def _descriptor(file: Any) -> int:
    return file if isinstance(file, int) else int(file.fileno())


class Poll:
    """select.poll()."""

    def __init__(self) -> None:
        self._poll = readers.select_poll()
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
        """Wait for `timeout` [ms, simulated]; without one, looks let time go on.

        multiprocessing's Connection.poll() and Queue.empty() look again until the clock is later than at first.
        """
        seconds = None if timeout is None else timeout / 1e3
        again = self._empty_ns == scheduler.now_ns and _thread.get_ident() not in scheduler.calling
        if seconds == 0 and again:
            seconds = scheduler.SLACK / 1e9
        ready = list(_when_ready(lambda: self._poll.poll(0), list(self._files.items()), seconds))
        self._empty_ns = -1 if ready else scheduler.now_ns
        return ready


class Epoll:
    """select.epoll()."""

    def __init__(self, *arguments: Any, **options: Any) -> None:
        self._epoll = _epoll(*arguments, **options)

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


_epoll, _select = select.epoll, select.select


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
        lambda: _select(*given, 0), list(wanted.items()), timeout
    )
    return ready


def install() -> None:
    """Have everything wait this way, also modules that have been imported already."""
    cls: Any = socket.socket
    cls.recv = _receiving(cls.recv, len, 1)
    cls.recv_into = _receiving(cls.recv_into, int, 2)
    cls.recvfrom = _receiving(cls.recvfrom, lambda result: len(result[0]), 1)
    cls.recvmsg = _receiving(cls.recvmsg, lambda result: len(result[0]), 2)
    cls.send, cls.sendall = _sending(cls.send), _sending(cls.sendall)
    accept, close, init, connect, listen = cls.accept, cls._real_close, cls.__init__, cls.connect, cls.listen

    @functools.wraps(accept)
    def accept_when_ready(listening: socket.socket) -> Any:
        _await(listening)
        accepted, address = accept(listening)
        link = traffic_of(accepted).link
        if link is not None:
            readers.accept(link)
        return accepted, address

    @functools.wraps(connect)
    def connect_and_count(connecting: socket.socket, *arguments: Any) -> None:
        connect(connecting, *arguments)
        traffic = traffic_of(connecting)
        traffic.accepted = any(it.link == (traffic.link or ())[::-1] for it in tuple(readers.received.values()))

    @functools.wraps(listen)
    def listen_and_count(listening: socket.socket, *arguments: Any) -> None:
        listen(listening, *arguments)
        if listening.family in (socket.AF_INET, socket.AF_INET6):
            readers.received[listening.fileno()] = Traffic((listening.getsockname()[1], 0))

    @functools.wraps(close)
    def forget_and_close(closed: socket.socket, *arguments: Any, **options: Any) -> None:
        _forget(closed)
        readers.close(closed.fileno())
        close(closed, *arguments, **options)

    @functools.wraps(init)
    def forget_and_init(opened: socket.socket, *arguments: Any, **options: Any) -> None:
        init(opened, *arguments, **options)
        _forget(opened)  # of an earlier one that was collected as garbage

    cls.accept, cls._real_close, cls.__init__ = accept_when_ready, forget_and_close, forget_and_init
    cls.connect, cls.listen = connect_and_count, listen_and_count
    module: Any = select
    module.poll, module.epoll, module.select = Poll, Epoll, simulated_select
    known: Any = selectors
    known.PollSelector._selector_cls, known.EpollSelector._selector_cls = Poll, Epoll
    known.SelectSelector._select = staticmethod(simulated_select)
