"""Distributes tasks to dask workers, local ones or those of an existing scheduler."""

import contextlib
import logging
import math
import os
import tempfile
import uuid
import warnings
from typing import Dict, Iterable, Iterator, List, Tuple, Union

import dask
from distributed import Client, Future, LocalCluster, as_completed, wait
from distributed.security import Security

from aro_robocop_goto_as.errors import GradingSetupError, NoTimeError, UngradableError

from ..runner import BUDGET
from .worker import Done, Place, Task, ready, work

CONNECT_PATIENCE = 60.0  # [s, wall]
LOCAL_PATIENCE = 600.0  # [s, wall] for what dask's processes on this machine, which may be busy, want of each other
SLOW = BUDGET / 4.0  # [s, wall] for one hand-in; a quiet machine needs half a minute
RETRIES = 1  # of a task that raised an error; tasks of workers that died are always repeated
# Hand-ins that are with the scheduler at a time: enough for the workers of a large cluster, few enough for its memory.
MOST_AHEAD = 100
MOST_BYTES_AHEAD = 256 * 1024**2
# Python before 3.11.5 may hang for ever in sys._current_frames(), which dask's profiler calls a hundred times a second,
# if a garbage collection, to which dask has added a callback, comes in the middle of it (CPython issue 106883).
PROFILER = "distributed.worker.profile.enabled"
SETTINGS = {
    PROFILER: False,
    # The scheduler remembers by default the last 100,000 transitions and events; nobody looks at those of a class.
    "distributed.scheduler.transition-log-length": 100,
    "distributed.scheduler.events-log-length": 100,
}
LOCAL_SETTINGS = {
    "distributed.comm.timeouts.connect": f"{LOCAL_PATIENCE:g}s",
    "distributed.comm.timeouts.tcp": f"{LOCAL_PATIENCE:g}s",
    "distributed.deploy.lost-worker-timeout": f"{LOCAL_PATIENCE:g}s",
    "distributed.scheduler.worker-ttl": None,  # a worker that says nothing for a while is not dead
}
START = "start workers with: ./robocop grade-worker"


def _shared_credentials(place: Place) -> Security:
    """TLS with the key that scheduler, workers and client share.

    Anyone who can reach the port of a scheduler without TLS can run any code on its workers, with their user's rights.
    """
    if not place.scheduler.startswith("tls://"):
        raise GradingSetupError(f"--scheduler {place.scheduler}: expected tls://HOST:PORT, see docs/grading.md")
    file = place.credentials
    if not os.path.isfile(file):
        raise GradingSetupError(f"--credentials {file}: expected the file with the scheduler's key and certificate")
    return Security(tls_ca_file=file, tls_client_cert=file, tls_client_key=file, require_encryption=True)


@contextlib.contextmanager
def connected(place: Place) -> Iterator[Client]:
    """A client of the scheduler at an address; without an address, of a local cluster of `workers` processes.

    GradingSetupError if the scheduler does not answer or one of its workers is not able to grade, NoTimeError if the
    local ones do not start.
    """
    # Interrupted, these report what they did not finish.
    logging.getLogger("asyncio").setLevel(logging.CRITICAL)
    warnings.filterwarnings("ignore", message="resource_tracker")
    with contextlib.ExitStack() as stack:
        stack.enter_context(dask.config.set(SETTINGS))
        if place.scheduler:
            scheduler, security = place.scheduler, _shared_credentials(place)
            try:
                client = stack.enter_context(Client(scheduler, timeout=CONNECT_PATIENCE, security=security))
            except (OSError, ValueError) as error:
                raise GradingSetupError(f"no dask scheduler answers at {scheduler}: {error}") from error
            if not client.scheduler_info()["workers"]:
                print(f"waiting for a worker at {scheduler}; {START} {scheduler}", flush=True)
                client.wait_for_workers(1)
        else:
            stack.enter_context(dask.config.set(LOCAL_SETTINGS))
            try:
                client = _local_client(stack, place.workers)
            except Exception as error:  # dask documents no list
                raise NoTimeError(f"dask's workers did not start: {error or type(error).__name__}") from error
        _expect_ready(client, place.unsafe)
        yield client


def _local_client(stack: contextlib.ExitStack, workers: int) -> Client:
    scratch = stack.enter_context(tempfile.TemporaryDirectory(prefix="robocop-dask-"))
    cluster = LocalCluster(
        n_workers=workers,
        threads_per_worker=1,
        processes=True,
        memory_limit=0,
        host="127.0.0.1",
        protocol="tls",
        security=Security.temporary(),  # a key that nobody else on this machine has
        dashboard_address="127.0.0.1:0",
        silence_logs=50,
        local_directory=scratch,
    )
    return stack.enter_context(Client(stack.enter_context(cluster), timeout=LOCAL_PATIENCE))


def _expect_ready(client: Client, unsafe: bool) -> None:
    try:
        answers = client.run(ready, unsafe)
    except Exception as error:  # a worker without this package, or with another dask protocol, may raise anything
        raise GradingSetupError(f"a worker is not able to grade: {error!r}; {START} ADDRESS") from error
    for worker, problem in answers.items():
        if problem:
            raise GradingSetupError(f"the worker at {worker} is not able to grade: {problem}")


class Pace:
    """How many hand-ins are graded at once: no more than are done in time."""

    def __init__(self, most: int, is_fixed: bool) -> None:
        self.at_once, self._most, self._is_fixed = most, most, is_fixed

    def note(self, seconds: float) -> None:
        """A hand-in has taken so long [s, wall]; infinity for one that was not done in time."""
        if self._is_fixed:
            return
        if seconds > SLOW:
            self.at_once = max(1, self.at_once // 2 if seconds == math.inf else self.at_once - 1)
        else:
            self.at_once = min(self._most, self.at_once + 1)


def _outcome(future: Future) -> Union[Done, NoTimeError, str]:
    """The report of a hand-in, or why it has no grade."""
    if future.status == "finished":
        result: Union[Done, NoTimeError] = future.result()
        return result
    error = future.exception() if future.status == "error" else "the connection to the scheduler was lost"
    if isinstance(error, (str, UngradableError)):
        return f"no grade: {error}"[:500]
    return f"could not be graded: {type(error).__name__}: {error}"[:500]


def grade_all(client: Client, tasks: Iterable[Task], pace: Pace) -> Iterator[Tuple[str, Union[Done, str]]]:
    """Each hand-in's name with its report or the reason why there is none, in order of completion.

    Takes a task when there is room for it, so that their hand-ins need not be in memory at the same time. Those for
    which the machine had no time are graded again at the end, one after the other.
    """
    run, waiting = uuid.uuid4().hex[:8], enumerate(tasks)  # `run` distinguishes several runs on one scheduler
    again: List[Task] = []
    ahead: Dict[Future, Task] = {}
    completed = as_completed()

    def submit() -> None:
        while len(ahead) < pace.at_once and sum(len(task.hand_in.packed) for task in ahead.values()) < MOST_BYTES_AHEAD:
            number, task = next(waiting, (0, None))
            if task is None:
                return
            future = client.submit(work, task, key=f"grade-{run}-{number}", retries=RETRIES)
            ahead[future] = task
            completed.add(future)

    try:
        submit()
        for future in completed:
            task, outcome = ahead.pop(future), _outcome(future)
            pace.note(outcome.seconds if isinstance(outcome, Done) else math.inf)
            submit()
            if isinstance(outcome, NoTimeError):
                again.append(task)
            else:
                yield task.hand_in.name, outcome
        for task in again:  # alone, when nothing else of the class runs
            future = client.submit(work, task, pure=False)
            ahead[future] = task
            wait(future)
            outcome = _outcome(future)
            yield task.hand_in.name, f"no grade: {outcome}" if isinstance(outcome, NoTimeError) else outcome
    finally:
        client.cancel([future for future in ahead if not future.done()])
