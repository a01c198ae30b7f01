"""A temporary folder for all that a program and its child processes write, removed when the program ends."""

import contextlib
import os
import tempfile
from pathlib import Path
from typing import Iterator, Optional

from ..process import signals, subreaper
from ..process.signals import Deferred
from . import tree


@contextlib.contextmanager
def scratch_folder() -> Iterator[None]:
    """Set TMPDIR to a new folder; at the end kill all descendants of this process, then remove the folder.

    Children that are interrupted leave temporary files behind (catkin's setup.sh, compilers), and orphans may still
    write some. Signals that arrive during the clean-up have no effect.
    """
    previous, folder = os.environ.get("TMPDIR"), None
    subreaper.adopt_orphans()
    try:
        with Deferred():
            folder = tempfile.mkdtemp(prefix="robocop-")
            _set_tmpdir(folder)
        yield
    finally:
        signals.begin_cleanup()
        subreaper.kill_descendants()
        _set_tmpdir(previous)
        if folder is not None:
            tree.remove(Path(folder))


def _set_tmpdir(folder: Optional[str]) -> None:
    """For child processes, and for this process's own temporary files."""
    tempfile.tempdir = folder
    if folder is None:
        os.environ.pop("TMPDIR", None)
    else:
        os.environ["TMPDIR"] = folder
