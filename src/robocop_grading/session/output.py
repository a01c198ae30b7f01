"""A node's output, line by line. It is read without a thread, by the loop that waits for the node."""

import contextlib
import fcntl
import os
import re
from typing import IO, Callable

MAX_READ = 1_000_000  # bytes that are kept until they are passed on; the rest is read and dropped
MAX_LINE = 2_000  # bytes; a longer one is several
PIPE = 1 << 20  # bytes that are read at once; the most that a pipe holds, unless root has raised the limit
F_SETPIPE_SZ = 1031  # of fcntl(2); Python has it since 3.10


class Output:
    """A node's output; each line is passed to `on_line`."""

    def __init__(self, stream: IO[bytes], on_line: Callable[[str], object]) -> None:
        self._stream, self._on_line = stream, on_line
        self._text = b""  # read, and not passed on yet
        self.is_open = True
        os.set_blocking(stream.fileno(), False)
        with contextlib.suppress(OSError):  # the user has very many pipes
            fcntl.fcntl(stream, F_SETPIPE_SZ, PIPE)  # a node blocked on a full pipe looks idle to its agent

    def fileno(self) -> int:
        return self._stream.fileno()

    def read(self) -> None:
        """Read what the node has printed so far."""
        try:
            data = os.read(self.fileno(), PIPE) if self.is_open else b""
        except BlockingIOError:  # nothing
            return
        self.is_open = bool(data)
        self._text += data[: max(0, MAX_READ - len(self._text))]

    def pass_on(self) -> None:
        """Read, and pass on all lines that have been printed; the last one, too, if it overwrites one or is the end."""
        self.read()
        overwrites = b"\r" in self._text.rpartition(b"\n")[2]
        *lines, self._text = re.split(rb"[\r\n]", self._text)
        if overwrites or not self.is_open:
            lines, self._text = [*lines, self._text], b""
        for line in lines:
            for start in range(0, len(line), MAX_LINE):
                self._on_line(line[start : start + MAX_LINE].decode(errors="replace"))

    def close(self) -> None:
        """Pass on all lines that were read, and read no more."""
        self.pass_on()
        self.is_open = False
        self.pass_on()
        self._stream.close()
