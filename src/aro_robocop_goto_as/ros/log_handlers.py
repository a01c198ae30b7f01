"""Log handlers that never make a node wait or fail, whatever becomes of the disk or the terminal.

A thread writes. Lines for which there is no room are dropped, and how many is logged when there is room again.
config/python_logging.conf names these handlers; rosmaster, roslaunch and all nodes in Python can use it.
"""

import contextlib
import logging
import os
import queue
import sys
import threading
from logging.handlers import RotatingFileHandler
from pathlib import Path
from typing import Any, TextIO, Union

import rospkg
from rosgraph.roslogging import RosStreamHandler

CONFIG = Path(__file__).resolve().parents[3] / "config" / "python_logging.conf"
KEPT = 1000  # lines that wait, as for a terminal that was stopped by Ctrl-S
PATIENCE = 1.0  # [s, wall] at the end of the program, for the lines that still wait


def use() -> None:
    """Log by these handlers in this process and those that it starts, unless the user has configured logging."""
    configured = Path(rospkg.get_ros_home(), "config").glob("python_logging.*")
    if not any(configured):
        os.environ.setdefault("ROS_PYTHON_LOG_CONFIG_FILE", str(CONFIG))


class Lossy:
    """A text stream that drops what can't be written."""

    def __init__(self, stream: TextIO) -> None:
        self.stream = stream

    def write(self, text: str) -> int:
        """Write a text; returns its length."""
        with contextlib.suppress(OSError):
            self.stream.write(text)
        return len(text)

    def flush(self) -> None:
        """Write what is buffered."""
        with contextlib.suppress(OSError):
            self.stream.flush()

    def __getattr__(self, name: str) -> Any:
        return getattr(self.stream, name)


class _Patient(logging.Handler):
    """Hands records on to another handler, in a thread."""

    def __init__(self, handler: logging.Handler) -> None:
        super().__init__()
        self._handler = handler
        setattr(handler, "handleError", _reraise)  # noqa: B010, which mypy refuses otherwise
        # Unlike Queue it can be used by a signal handler that interrupts its use.
        self._waiting: queue.SimpleQueue[Union[logging.LogRecord, threading.Event]] = queue.SimpleQueue()
        self._dropped = 0  # lines, by callers
        self._failed = self._reported = 0  # by the thread
        self._reason, self._level = "nobody reads the output", logging.INFO  # of the newest failure
        threading.Thread(target=self._write_all, name="log", daemon=True).start()

    def setFormatter(self, fmt: Any) -> None:  # noqa: N802, of logging.Handler
        """Set the other handler's formatter."""
        self._handler.setFormatter(fmt)

    def emit(self, record: logging.LogRecord) -> None:
        """Queue a record; drop it if too many wait."""
        if self._waiting.qsize() < KEPT:
            self._waiting.put(record)
        else:
            self._dropped += 1

    def flush(self) -> None:
        """Wait for a moment until what was logged so far is written."""
        written = threading.Event()
        self._waiting.put(written)
        written.wait(PATIENCE)

    def _write_all(self) -> None:
        while True:
            record = self._waiting.get()
            try:
                self._report_lost()
                if isinstance(record, logging.LogRecord):
                    self._handler.emit(record)
            except Exception as error:  # the thread's outermost level: a full disk, a closed terminal, a broken message
                self._reason = str(error)
                if isinstance(record, logging.LogRecord):
                    self._failed += 1
                    self._level = record.levelno
            if isinstance(record, threading.Event):
                record.set()

    def _report_lost(self) -> None:
        """When all that waited is written: how many lines are missing. At the level of the newest, by its stream."""
        lost = self._dropped + self._failed - self._reported
        if lost and self._waiting.empty():
            note = {"name": "rosout", "levelno": self._level, "levelname": logging.getLevelName(self._level)}
            self._handler.emit(logging.makeLogRecord({**note, "msg": f"{lost} log lines were lost: {self._reason}"}))
            self._reported += lost


def _reraise(_: logging.LogRecord) -> None:
    """Called while an exception is handled; logging itself would print a traceback."""
    raise  # noqa: PLE0704


class _Reopened(RotatingFileHandler):
    def emit(self, record: logging.LogRecord) -> None:
        """Write a line; after an error the file is closed, with what is buffered, and opened for the next line."""
        try:
            super().emit(record)
        except Exception:  # whatever it is
            stream, self.stream = self.stream, None  # type: ignore[assignment]
            with contextlib.suppress(OSError):
                stream.close()
            raise


class File(_Patient):
    """A log file, as logging's RotatingFileHandler; it is opened when the first line is written."""

    def __init__(self, filename: str, mode: str, size: int, count: int) -> None:
        super().__init__(_Reopened(filename, mode, size, count, delay=True))


class Terminal(_Patient):
    """Standard output, and standard error for warnings and errors, as ROS' own handler."""

    def __init__(self, colorize: bool) -> None:
        stdout = sys.stdout.stream if isinstance(sys.stdout, Lossy) else sys.stdout  # to know what is lost
        super().__init__(RosStreamHandler(colorize, stdout))
