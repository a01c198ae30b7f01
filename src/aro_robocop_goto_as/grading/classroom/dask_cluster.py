"""Distributes tasks to dask workers, local ones or those of an existing scheduler."""

import contextlib
import logging
import os
import tempfile
import uuid
import warnings
from typing import Dict, Iterable, Iterator, Tuple, Union

import dask
from distributed import Client, Future, LocalCluster, as_completed
from distributed.security import Security

from ...errors import GradingSetupError
from .worker import Done, Place, Task, ready, work

CONNECT_PATIENCE = 5.0  # [s, wall]
RETRIES = 1  # of a task that raised an error; tasks of workers that died are always repeated
# Hand-ins that are with the scheduler at a time: enough for the workers of a large cluster, few enough for its memory.
MOST_AHEAD = 100
MOST_BYTES_AHEAD = 256 * 1024**2
# The scheduler remembers by default the last 100,000 transitions and events; nobody looks at those of a class.
SHORT_LOGS = {"distributed.scheduler.transition-log-length": 100, "distributed.scheduler.events-log-length": 100}
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

    GradingSetupError if the scheduler does not answer or one of its workers is not able to grade.
    """
    # Interrupted, these report what they did not finish.
    logging.getLogger("asyncio").setLevel(logging.CRITICAL)
    warnings.filterwarnings("ignore", message="resource_tracker")
    with contextlib.ExitStack() as stack:
        stack.enter_context(dask.config.set(SHORT_LOGS))
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
            scratch = stack.enter_context(tempfile.TemporaryDirectory(prefix="robocop-dask-"))
            cluster = stack.enter_context(
                LocalCluster(
                    n_workers=place.workers,
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
            )
            client = stack.enter_context(Client(cluster))
        _expect_ready(client, place.unsafe)
        yield client


def _expect_ready(client: Client, unsafe: bool) -> None:
    try:
        answers = client.run(ready, unsafe)
    except Exception as error:  # a worker without this package, or with another dask protocol, may raise anything
        raise GradingSetupError(f"a worker is not able to grade: {error!r}; {START} ADDRESS") from error
    for worker, problem in answers.items():
        if problem:
            raise GradingSetupError(f"the worker at {worker} is not able to grade: {problem}")


def grade_all(client: Client, tasks: Iterable[Task]) -> Iterator[Tuple[str, Union[Done, str]]]:
    """Each hand-in's name with its report or the reason why there is none, in order of completion.

    Takes a task when there is room for it, so that their hand-ins need not be in memory at the same time.
    """
    run, waiting = uuid.uuid4().hex[:8], enumerate(tasks)  # `run` distinguishes several runs on one scheduler
    ahead: Dict[Future, Tuple[str, int]] = {}  # name and size of each hand-in
    completed = as_completed()

    def submit() -> None:
        while len(ahead) < MOST_AHEAD and sum(size for _, size in ahead.values()) < MOST_BYTES_AHEAD:
            number, task = next(waiting, (0, None))
            if task is None:
                return
            future = client.submit(work, task, key=f"grade-{run}-{number}", retries=RETRIES)
            ahead[future] = task.hand_in.name, len(task.hand_in.packed)
            completed.add(future)

    try:
        submit()
        for future in completed:
            name, _ = ahead.pop(future)
            submit()
            if future.status == "finished":
                yield name, future.result()
            else:
                error = future.exception() if future.status == "error" else "the connection to the scheduler was lost"
                yield name, f"could not be graded: {error!r}"[:500]
    finally:
        client.cancel([future for future in ahead if not future.done()])
