"""Somebody's node as a process: started, listened to, ended to its last child."""

import subprocess
import threading
from typing import Any, Callable, Dict, List, Optional

from ..guard import Guard, kill_group

MOST_OUTPUT = 200_000  # bytes of a node's output that are kept; what a node writes beyond it is read and dropped
LONGEST_LINE = 2_000


class Node:
    """One node; every line of its output goes to `on_line`, from a thread."""

    def __init__(self, command: List[str], environment: Dict[str, str], folder: str,
                 on_line: Callable[[str], Any]) -> None:
        self.process = subprocess.Popen(command, env=environment, cwd=folder, stdin=subprocess.DEVNULL,
                                        stdout=subprocess.PIPE, stderr=subprocess.STDOUT, start_new_session=True)
        self.guard = Guard(self.process.pid)
        self._on_line = on_line
        threading.Thread(target=self._read, daemon=True).start()

    def _read(self) -> None:
        stream, kept = self.process.stdout, 0
        assert stream is not None
        while True:
            line = stream.readline(LONGEST_LINE)
            if not line:
                return
            kept += len(line)
            if kept <= MOST_OUTPUT:
                self._on_line(line.decode(errors="replace").rstrip("\n"))

    def death(self) -> Optional[int]:
        """The exit status of a node that ended by itself."""
        return self.process.poll()

    def end(self) -> None:
        """End the node and its children at once: what it would say of being interrupted is not its author's fault."""
        self.guard.stop()
        kill_group(self.process.pid)
        self.process.wait()
