"""Threads: counted from the moment at which they are started, joined by way of the scheduler."""

import _thread
import functools
import threading
from typing import Any, Dict, Optional

from .locks import Lock
from .scheduler import Waiter, scheduler
from .scheduler import start_new_thread as start_unknown_thread

native_ids: Dict[int, int] = {}  # of the threads that exist, by their identity


def _begin(waiter: Waiter) -> None:
    native_ids[_thread.get_ident()] = threading.get_native_id()
    scheduler.begin(waiter)


def _end() -> None:
    native_ids.pop(_thread.get_ident(), None)
    scheduler.end()


def register_main() -> None:
    """Register the calling thread as the hand-in's main thread."""
    scheduler.running.add(_thread.get_ident())
    native_ids[_thread.get_ident()] = threading.get_native_id()


def _join_others() -> None:
    """Wait for the threads that Python waits for at the end of the main thread."""
    me = threading.current_thread()
    while True:
        others = [thread for thread in threading.enumerate() if thread is not me and not thread.daemon]
        if not others:
            return
        others[0].join()


def install() -> None:
    """Count all threads that are started from now on."""
    system: Any = threading
    # The first to be registered is called last. Python 3.8 waits by itself, which stuck.py sees.
    getattr(system, "_register_atexit", lambda _: None)(_join_others)
    _install_thread_class()
    system = _thread
    system.start_new_thread = system.start_new = _start_new_thread


def _install_thread_class() -> None:
    """threading.Thread: its start, run and join."""
    cls: Any = threading.Thread
    start, bootstrap, join = cls.start, cls._bootstrap, cls.join

    @functools.wraps(start)
    def counted_start(thread: Any) -> None:
        if not scheduler.active or thread._started.is_set():
            return start(thread)
        thread.robocop_end = Lock()
        thread.robocop_end.acquire()
        thread.robocop_turn = scheduler.new_thread()
        try:
            start(thread)
        except RuntimeError:  # no more threads
            scheduler.cancel_start(thread.robocop_turn)
            raise

    @functools.wraps(bootstrap)
    def counted_bootstrap(thread: Any) -> None:
        if not hasattr(thread, "robocop_turn"):
            return bootstrap(thread)
        _begin(thread.robocop_turn)
        try:
            bootstrap(thread)
        finally:
            thread.robocop_end.release()
            _end()

    @functools.wraps(join)
    def simulated_join(thread: Any, timeout: Optional[float] = None) -> None:
        end = getattr(thread, "robocop_end", None)
        if not scheduler.active or end is None or thread is threading.current_thread():
            return join(thread, timeout)
        if end.acquire(True, -1 if timeout is None else max(0.0, timeout)):
            end.release()
            join(thread)

    cls.start, cls._bootstrap, cls.join = counted_start, counted_bootstrap, simulated_join


@functools.wraps(_thread.start_new_thread)
def _start_new_thread(function: Any, arguments: Any, options: Any = {}) -> int:  # noqa: B006  as the system's
    if not scheduler.active:
        return start_unknown_thread(function, arguments, options)
    turn = scheduler.new_thread()

    def counted() -> None:
        _begin(turn)
        try:
            function(*arguments, **options)
        finally:
            _end()

    try:
        return start_unknown_thread(counted, ())
    except RuntimeError:  # no more threads
        scheduler.cancel_start(turn)
        raise
