"""dask's workers, on this machine or of an existing scheduler; each worker does one task at a time."""

import contextlib
import logging
import os
import sys
import tempfile
import warnings
from pathlib import Path
from typing import Callable, Iterator, Sequence, Tuple

import dask
from distributed import Client, Future, LocalCluster, as_completed
from distributed.security import Security

from ..errors import GradingSetupError, UngradableError

# Python before 3.11.5 may hang for ever in sys._current_frames(), which dask's profiler calls a hundred times a second,
# if a garbage collection, to which dask has added a callback, comes in the middle of it (CPython issue 106883).
SETTINGS = {
    "distributed.worker.profile.enabled": False,
    # A worker that has died is started again, however long that takes; only the hand-in that it ran is held against.
    "distributed.deploy.lost-worker-timeout": "1h",
    "distributed.scheduler.worker-saturation": 1.0,  # no hand-in waits at a worker
}


def send_child_errors_to(log: Path) -> None:
    """Redirect the standard error of future child processes, but not of this one, to `log` (overwritten).

    For libraries that start processes themselves: interrupted, those of dask and multiprocessing print tracebacks.
    """
    sys.stderr.flush()
    terminal = os.dup(2)  # not inherited
    sys.stderr = open(terminal, "w", buffering=1, encoding=sys.stderr.encoding, errors="backslashreplace")
    with open(log, "wb") as file:
        os.dup2(file.fileno(), 2)


@contextlib.contextmanager
def connected(scheduler: str, workers: int) -> Iterator[Client]:
    """A client of the scheduler at an address, with the keys of dask's own configuration.

    Without an address, a client of new `workers` on this machine. GradingSetupError if that is not
    possible.
    """
    # Interrupted, these report what they did not finish.
    logging.getLogger("asyncio").setLevel(logging.CRITICAL)
    warnings.filterwarnings("ignore", message="resource_tracker")
    with contextlib.ExitStack() as stack:
        stack.enter_context(dask.config.set(SETTINGS))
        try:
            cluster = scheduler or stack.enter_context(_local_cluster(workers))
            client = stack.enter_context(Client(cluster))
        except Exception as error:  # dask documents no list
            where = f"no dask scheduler answers at {scheduler}" if scheduler else "dask's workers did not start"
            raise GradingSetupError(f"{where}: {error or type(error).__name__}") from error
        if not client.scheduler_info()["workers"]:
            print(f"{scheduler} has no workers yet; docs/grading.md says how to start them", flush=True)
        yield client


def _local_cluster(workers: int) -> LocalCluster:
    return LocalCluster(
        n_workers=workers,
        threads_per_worker=1,
        memory_limit=0,  # with many cores a worker takes more than its share, and would wait for ever
        host="127.0.0.1",
        protocol="tls",
        security=Security.temporary(),  # a key that nobody else on this machine has: its port executes anybody's code
        dashboard_address="127.0.0.1:0",
        silence_logs=logging.CRITICAL,
        local_directory=tempfile.gettempdir(),
    )


def done(client: Client, task: Callable[[Path], None], paths: Sequence[Path]) -> Iterator[Tuple[Path, str]]:
    """Each path once its task has ended, with the reason if it did not succeed."""
    futures = dict(zip(client.map(task, paths, pure=False), paths))
    for future in as_completed(futures):
        yield futures.pop(future), _problem(future)


def _problem(future: Future) -> str:
    if future.status == "finished":
        return ""
    error = future.exception() if future.status == "error" else "the connection to the scheduler was lost"
    if isinstance(error, (str, UngradableError)):
        return f"no grade: {error}"
    return f"could not be graded: {type(error).__name__}: {error}"
