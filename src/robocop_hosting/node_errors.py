"""What the nodes of a hosted package print to standard error, with the paths of its author's files."""

import os
import re
import sys
import threading
from pathlib import Path
from typing import Dict, List, Mapping, Tuple

from .scripts import NODE_NAMES

STDERR = 2  # file descriptor
END_TIMEOUT = 2.0  # [s, wall] for what ended programs have printed; a process that is left may keep the pipe open
COLOUR = re.compile("\x1b[^m]*m")
FRAME = re.compile(r' +File "(.+)", line (\d+)')
# By roslaunch, followed by a line about its log file; the second one by this simulator's roslaunch.
DIED = re.compile(r"\[(\S+)-\d+\] process has died \[pid \d+, exit code (-?\d+), cmd (\S+)")
LOG_FILE = "log file: "
ENDED = re.compile(r"\[WARN\] \S+ has ended, without an error")
# What to know of an exception in one's own code whose words do not say what to do.
NOT_IMPORTED = "tf2 can transform messages of geometry_msgs only after: import tf2_geometry_msgs"
HINTS = {
    "Have you called init_node()?": "rospy.init_node(NAME) has to come first; correct that, and start sim --with again",
    "if not loaded or supported": NOT_IMPORTED,
    "ROS shutdown request": "the node was told to end, as by Ctrl-C; that is no mistake",
}
PARTS = {name: f"your {part}" for part, name in NODE_NAMES.items()}


class NodeErrors:
    """Standard error of this process and its children while the context is entered.

    In each line, a path of the copy that runs becomes the path of the original. roslaunch's message that a node has
    died becomes a sentence with the node's exception, which is shown once `show` was called, below the overview.
    """

    def __init__(self, originals: Mapping[Path, Path]) -> None:
        """originals: the author's folder of each copied package."""
        self._originals = {f"{copy}/": f"{original}/" for copy, original in originals.items()}
        self._frames: List[Tuple[str, str]] = []  # file and line, of the traceback that is being printed
        self._errors: Dict[str, str] = {}  # by the name of each file in the traceback
        self._lock = threading.Lock()
        self._ended: List[str] = []  # sentences
        self._is_shown = False

    def __enter__(self) -> "NodeErrors":
        reader, writer = os.pipe()
        self._screen = os.fdopen(os.dup(STDERR), "w", errors="surrogateescape", buffering=1)
        os.dup2(writer, STDERR)
        os.close(writer)
        self._thread = threading.Thread(target=self._copy, args=(reader,), daemon=True)
        self._thread.start()
        return self

    def __exit__(self, *_: object) -> None:
        sys.stderr.flush()
        os.dup2(self._screen.fileno(), STDERR)
        self._thread.join(END_TIMEOUT)
        self.show()

    def show(self) -> None:
        """Show which nodes have ended so far, and from now on at once."""
        with self._lock:
            self._is_shown = True
            self._screen.writelines(self._ended)
            self._ended.clear()

    def _copy(self, reader: int) -> None:
        is_after_death = False
        with open(reader, errors="surrogateescape") as lines:
            for line in lines:
                for copy, original in self._originals.items():
                    line = line.replace(copy, original)
                plain = COLOUR.sub("", line)
                died = DIED.match(plain)
                if died:
                    self._tell(f"[ERROR] {self._sentence(*died.groups())}\n")
                elif ENDED.match(plain):
                    self._tell(line)
                elif not (is_after_death and plain.startswith(LOG_FILE)):
                    self._screen.write(line)
                self._note(plain.rstrip("\n"))
                is_after_death = died is not None

    def _note(self, line: str) -> None:
        """Keep the exception at the end of a traceback, under the names of the files in it."""
        frame = FRAME.match(line)
        if frame:
            self._frames.append((frame[1], frame[2]))
        elif self._frames and line and not line.startswith(" "):
            own = [it for it in self._frames if it[0].startswith(tuple(self._originals.values()))]
            file, number = (own or self._frames)[-1]
            for words, hint in HINTS.items():
                if own and words in line:
                    self._tell(f"[WARN] {os.path.basename(file)}, line {number}: {hint}\n")
            for name, _ in self._frames:
                self._errors[os.path.basename(name)] = f"{line} ({file}, line {number})"
            self._frames = []

    def _sentence(self, name: str, code: str, program: str) -> str:
        who = f"{PARTS[name]} ({name})" if name in PARTS else name
        reason = self._errors.get(os.path.basename(program)) if int(code) > 0 else None
        if reason:
            return f"{who} has ended: {reason}. Correct that, and start sim --with again"
        return f"{who} has ended, " + (f"with exit status {code}" if int(code) > 0 else f"by signal {-int(code)}")

    def _tell(self, sentence: str) -> None:
        with self._lock:
            self._ended.append(sentence)
        if self._is_shown:
            self.show()
