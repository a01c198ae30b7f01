"""Grades a packed hand-in on a dask worker and returns the files of its report."""

import contextlib
import dataclasses
import faulthandler
import os
import socket
import time
from dataclasses import dataclass, field
from pathlib import Path
from typing import Dict, Iterator, Optional, Union

from aro_robocop_goto_as.errors import NoTimeError, RobocopError, SubmissionError, UngradableError

from ..builds.workspace import places
from ..files.tree import temporary_folder
from ..grader import grade
from ..judge import Grade
from ..plan import Plan
from ..report.write import write
from ..runner import BUDGET, Runner
from ..sandbox.bubblewrap import open_sandbox
from ..submission import lab_environment, prepare_submission
from .hand_ins import HandIn, unpack

MOST_PROBLEM = 4_000  # characters
# [s, wall] for one hand-in. The limits of its parts, attempts and builds are less than that in sum: a worker that takes
# longer hangs itself.
LONGEST = 8.0 * BUDGET


@dataclass(frozen=True)
class Task:
    """A hand-in with the options for grading it."""

    hand_in: HandIn
    plan: Plan
    unsafe: bool = False


@dataclass(frozen=True)
class Place:
    """Where a class is graded."""

    scheduler: str = ""  # tls://HOST:PORT; none: local workers
    credentials: str = ""  # PEM file with the key and the certificate that scheduler, workers and client share
    workers: int = 1  # local ones
    unsafe: bool = False


@dataclass(frozen=True)
class Done:
    """The report of a hand-in; one that could not be graded has a report that states the problem."""

    name: str
    digest: str
    files: Dict[str, bytes] = field(default_factory=dict)
    seconds: float = 0.0
    worker: str = ""


def work(task: Task) -> Union[Done, NoTimeError]:
    """Grade one hand-in; its mistakes go into the report, other errors are raised.

    A NoTimeError is returned: dask would repeat at once what raises an error.
    """
    started, name = time.monotonic(), task.hand_in.name.encode("utf-8", "replace").decode()
    state, share = places()
    with ended_if_it_hangs(LONGEST), temporary_folder("robocop-class-", _scratch()) as top:
        folder = top / "report"
        try:
            sandbox = open_sandbox(task.unsafe, [state / "venv", state / "compat"])
            if task.hand_in.problem:
                raise SubmissionError(task.hand_in.problem)
            path = unpack(task.hand_in, top / "hand_in")
            submission = prepare_submission(str(path), share, state, top / "workshop", sandbox)
            notes = [*submission.notes, *task.hand_in.notes]
            submission = dataclasses.replace(submission, name=name, notes=notes)
            grade(Runner(task.plan, state, sandbox), submission, folder, scratch=top)
        except NoTimeError as error:
            return error
        except UngradableError:
            raise
        except Exception as error:  # a hand-in that breaks the grader affects only its own row
            folder.mkdir(exist_ok=True)
            problem = str(error) if isinstance(error, RobocopError) else f"could not be graded: {error!r}"
            problem = problem.replace(f"{top / 'hand_in'}/", "").replace(f"{top}/", "")[:MOST_PROBLEM]
            write(Grade(name, (), (problem, *task.hand_in.notes)), task.plan, {}, folder)
        files = {entry.name: entry.read_bytes() for entry in sorted(folder.iterdir())}
    return Done(
        task.hand_in.name,
        task.hand_in.digest,
        files,
        time.monotonic() - started,
        f"{socket.gethostname()}:{os.getpid()}",
    )


@contextlib.contextmanager
def ended_if_it_hangs(limit: float) -> Iterator[None]:
    """End this process with a traceback if the block takes longer than `limit` [s, wall], though nothing can run in it.

    Dask then starts another worker and gives it the hand-in. One at a time in a process.
    """
    faulthandler.dump_traceback_later(limit, exit=True)  # by a thread that does not need the interpreter
    try:
        yield
    finally:
        faulthandler.cancel_dump_traceback_later()


def _scratch() -> Optional[Path]:
    """This dask worker's folder, which dask removes even after the worker was killed."""
    from distributed import get_worker  # takes half a second

    try:
        return Path(get_worker().local_directory)
    except ValueError:  # not a dask worker
        return None


def ready(unsafe: bool) -> str:
    """Prepare this worker's machine; what it lacks for grading, or nothing."""
    try:
        state, share = places()
        open_sandbox(unsafe, [state / "venv"])
        lab_environment(share, state)
    except NoTimeError:
        pass  # each hand-in tries again
    except RobocopError as error:
        return str(error)
    return ""
