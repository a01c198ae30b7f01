"""The submission's node as a child process whose output is read line by line."""

import threading
from functools import partial
from pathlib import Path
from subprocess import PIPE, STDOUT
from typing import Any, Callable, Dict, List, Optional

from ...process import child
from ..resource_guard import Guard

MAX_OUTPUT = 200_000  # bytes of a node's output that are kept; the rest is read and dropped
MAX_LINE = 2_000  # bytes


class Node:
    """One node; a thread passes every line of its output to `on_line`."""

    def __init__(
        self, command: List[str], environment: Dict[str, str], folder: str, on_line: Callable[[str], Any]
    ) -> None:
        self._process = child.start(command, environment=environment, folder=Path(folder), stdout=PIPE, stderr=STDOUT)
        self.guard = Guard(self._process.pid)
        self._on_line = on_line
        threading.Thread(target=self._read, daemon=True).start()

    def _read(self) -> None:
        stream, size = self._process.stdout, 0
        assert stream is not None
        for line in iter(partial(stream.readline, MAX_LINE), b""):
            size += len(line)
            if size <= MAX_OUTPUT:
                self._on_line(line.decode(errors="replace").rstrip("\n"))

    @property
    def pid(self) -> int:
        """The id of its outermost process."""
        return int(self._process.pid)

    def status(self) -> Optional[int]:
        """The exit status of a node that ended by itself; None while it runs."""
        return self._process.poll()

    def end(self) -> None:
        """SIGKILL the node and its children. With SIGTERM, shutdown messages would be recorded as errors."""
        self.guard.stop()
        child.kill_tree(self._process.pid)
        self._process.wait()
