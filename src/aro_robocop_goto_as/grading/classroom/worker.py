"""What a dask worker does: a packed hand-in -> the files of its report, as bytes, so that no disk has to be shared."""

import dataclasses
import os
import socket
import tarfile
import tempfile
import time
from dataclasses import dataclass, field
from pathlib import Path
from typing import Dict, Optional

from ...errors import RobocopError
from ..exam import examine
from ..judge import Grade
from ..plan import load
from ..report import write
from ..sandbox import cage
from ..submission import lab_environment, take
from .hand_ins import HandIn, unpack


@dataclass(frozen=True)
class Task:
    """A hand-in, and how it is to be graded."""

    hand_in: HandIn
    plan: str  # the text of config/grading.yaml
    unsafe: bool = False


@dataclass(frozen=True)
class Done:
    """What came of it; with a problem, it could not be graded, and there is still a report that says why."""

    name: str
    digest: str
    files: Dict[str, bytes] = field(default_factory=dict)
    seconds: float = 0.0
    worker: str = ""


def work(task: Task) -> Done:
    """Grade one hand-in. What is wrong with it is in its report; errors of this machine are raised."""
    started, name = time.monotonic(), task.hand_in.name.encode("utf-8", "replace").decode()
    state, share = Path(os.environ["ROBOCOP_STATE"]), Path(os.environ["ROBOCOP_SHARE"])
    with tempfile.TemporaryDirectory(prefix="robocop-class-", dir=_scratch()) as made:
        top, folder = Path(made), Path(made, "report")
        plan = top / "plan.yaml"
        plan.write_text(task.plan, encoding="utf-8")
        around = cage(task.unsafe, [state / "venv", state / "compat"])
        try:
            if task.hand_in.problem:
                raise HandInRefused(task.hand_in.problem)
            path = _unpacked(task.hand_in, top / "hand_in")
            submission = take(str(path), share, state, top / "workshop", around)
            submission = dataclasses.replace(submission, name=name)
            examine(submission, plan, folder, state, around, scratch=top)
        except RobocopError as error:
            folder.mkdir(exist_ok=True)
            words = str(error).replace(f"{top / 'hand_in'}/", "").replace(f"{top}/", "")
            write(Grade(name, (), (words,)), load(plan), {}, folder)
        files = {entry.name: entry.read_bytes() for entry in sorted(folder.iterdir())}
    return Done(task.hand_in.name, task.hand_in.digest, files, time.monotonic() - started,
                f"{socket.gethostname()}:{os.getpid()}")


def _scratch() -> Optional[str]:
    """The folder of this process as a dask worker, which is cleaned up even when the worker was killed."""
    from distributed import get_worker  # half a second
    try:
        return str(get_worker().local_directory)
    except ValueError:  # it is none
        return None


def _unpacked(hand_in: HandIn, folder: Path) -> Path:
    try:
        return unpack(hand_in, folder)
    except (OSError, tarfile.TarError) as error:  # such as a name that is a file's and a folder's
        raise HandInRefused(f"can't be unpacked: {error}") from error


class HandInRefused(RobocopError):
    """It could not even be packed."""


def ready(unsafe: bool) -> str:
    """Make this worker's machine ready, and say what it lacks for this work; nothing, if it can do it."""
    for name in ("ROBOCOP_STATE", "ROBOCOP_SHARE"):
        if not os.environ.get(name):
            return f"{name} is not set: start workers with ./robocop grade-worker"
    state, share = Path(os.environ["ROBOCOP_STATE"]), Path(os.environ["ROBOCOP_SHARE"])
    try:
        cage(unsafe, [state / "venv"])
        lab_environment(share, state)
    except RobocopError as error:
        return str(error)
    return ""
