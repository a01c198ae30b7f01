"""Dask: workers of one's own, or those of a scheduler that is there already; tasks in, results out as they come."""

import contextlib
import tempfile
import uuid
from typing import Iterator, Sequence, Tuple, Union

from distributed import Client, LocalCluster, as_completed

from ...errors import GradingError
from .worker import Done, Task, ready, work

CONNECT_PATIENCE = 5.0  # [s, wall]
RETRIES = 1  # of a task that a worker's machine could not do; whose worker died is done again in any case
START = "start workers with: ./robocop grade-worker"


@contextlib.contextmanager
def connected(scheduler: str, workers: int, unsafe: bool) -> Iterator[Client]:
    """A client of the scheduler at an address, or of a cluster of `workers` processes here, if the address is empty.

    GradingError where nobody answers, or a worker that is there can't do the work.
    """
    with contextlib.ExitStack() as stack:
        if scheduler:
            try:
                client = stack.enter_context(Client(scheduler, timeout=CONNECT_PATIENCE))
            except (OSError, ValueError) as error:
                raise GradingError(f"no dask scheduler answers at {scheduler}: {error}") from error
            if not client.scheduler_info()["workers"]:
                print(f"no worker at {scheduler} yet; {START} {scheduler}", flush=True)
                client.wait_for_workers(1)
        else:
            place = stack.enter_context(tempfile.TemporaryDirectory(prefix="robocop-dask-"))
            cluster = stack.enter_context(LocalCluster(
                n_workers=workers, threads_per_worker=1, processes=True, memory_limit=0, host="127.0.0.1",
                dashboard_address="127.0.0.1:0", silence_logs=50, local_directory=place))
            client = stack.enter_context(Client(cluster))
        _expect_ready(client, unsafe)
        yield client


def _expect_ready(client: Client, unsafe: bool) -> None:
    try:
        answers = client.run(ready, unsafe)
    except Exception as error:  # whatever a worker raises that lacks this package, or another dask's protocol
        raise GradingError(f"a worker can't do this work: {error!r}; {START} ADDRESS") from error
    for worker, lacks in answers.items():
        if lacks:
            raise GradingError(f"the worker at {worker} can't do this work: {lacks}")


def grade_all(client: Client, tasks: Sequence[Task]) -> Iterator[Tuple[str, Union[Done, str]]]:
    """Each task's name with what came of it, or with the words why nothing did; in the order they are done."""
    run = uuid.uuid4().hex[:8]  # another run on the same scheduler is none of ours
    futures = {client.submit(work, task, key=f"grade-{run}-{number}", retries=RETRIES): task.hand_in.name
               for number, task in enumerate(tasks)}
    try:
        for future in as_completed(futures):
            if future.status == "finished":
                yield futures[future], future.result()
            else:
                error = future.exception() if future.status == "error" else "the scheduler is gone"
                yield futures[future], f"could not be graded: {error!r}"[:500]
    finally:
        client.cancel([future for future in futures if not future.done()])
