"""A temporary folder for all that a program and its child processes write, removed when the program ends."""

import contextlib
import fcntl
import os
import tempfile
from pathlib import Path
from typing import Iterator, Optional

from aro_robocop_goto_as.errors import HostingError
from aro_robocop_goto_as.process import orphans, signals
from aro_robocop_goto_as.process.signals import Deferred

from . import tree

PREFIX = "robocop-scratch-"
UNLOCKED = ".robocop-scratch-"  # until it is locked


@contextlib.contextmanager
def scratch_folder() -> Iterator[None]:
    """Set TMPDIR to a new folder; at the end kill all descendants of this process, then remove the folder.

    Children that are interrupted leave temporary files behind (catkin's setup.sh, compilers), and orphans may still
    write some. Signals that arrive during the clean-up have no effect. This process locks its folder; folders that
    nobody locks, as their owner was killed, are removed at the beginning.
    """
    previous, folder, lock = os.environ.get("TMPDIR"), None, -1
    orphans.adopt_orphans()
    _remove_abandoned(Path(tempfile.gettempdir()))
    try:
        with Deferred():
            made = Path(tempfile.mkdtemp(prefix=UNLOCKED))
            lock = os.open(made, os.O_RDONLY)  # not inherited by programs that are started
            fcntl.flock(lock, fcntl.LOCK_EX)
            folder = made.rename(made.with_name(made.name.replace(UNLOCKED, PREFIX)))
            _set_tmpdir(str(folder))
        yield
    finally:
        signals.begin_cleanup()
        orphans.kill_descendants()
        _set_tmpdir(previous)
        if folder is not None:
            tree.remove(folder)
            os.close(lock)


def _remove_abandoned(parent: Path) -> None:
    for folder in parent.glob(f"{PREFIX}*"):
        with contextlib.suppress(OSError, HostingError):  # another user's, or in use
            lock = os.open(folder, os.O_RDONLY | os.O_DIRECTORY | os.O_NOFOLLOW)
            try:
                fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
                tree.remove(folder)
            finally:
                os.close(lock)


def _set_tmpdir(folder: Optional[str]) -> None:
    """For child processes, and for this process's own temporary files."""
    tempfile.tempdir = folder
    if folder is None:
        os.environ.pop("TMPDIR", None)
    else:
        os.environ["TMPDIR"] = folder
