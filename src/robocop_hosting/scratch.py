"""A temporary folder for all that a program and its child processes write, removed when the program ends."""

import contextlib
import os
import tempfile
from typing import Iterator, Optional

from aro_robocop_goto_as.process import signals

from . import orphans


@contextlib.contextmanager
def scratch_folder() -> Iterator[None]:
    """Set TMPDIR to a new folder; at the end kill all descendants of this process, then remove the folder.

    Children that are interrupted leave temporary files behind (catkin's setup.sh, compilers), and orphans may still
    write some. Signals that arrive during the clean-up have no effect.
    """
    previous = os.environ.get("TMPDIR")
    orphans.adopt_orphans()
    # Earlier versions remove folders called robocop-scratch-* that nobody locks.
    with tempfile.TemporaryDirectory(prefix="robocop-temporary-") as folder:
        try:
            _set_tmpdir(folder)
            yield
        finally:
            signals.begin_cleanup()
            orphans.kill_descendants()
            _set_tmpdir(previous)


def _set_tmpdir(folder: Optional[str]) -> None:
    """For child processes, and for this process's own temporary files."""
    tempfile.tempdir = folder
    if folder is None:
        os.environ.pop("TMPDIR", None)
    else:
        os.environ["TMPDIR"] = folder
