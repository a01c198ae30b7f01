"""Exceptions in judging: each costs an explanation, never a grade, and leaves its traceback in the report's folder."""

import time
import traceback
from pathlib import Path
from typing import Any, Callable, List, Sequence, TypeVar

FILE = "traceback.txt"  # in the report's folder
SOURCES = Path(__file__).resolve().parents[1]
STARTED = time.time()  # [s, wall]
T = TypeVar("T")


class Faults:
    """The exceptions of one grading."""

    def __init__(self) -> None:
        self.told: List[str] = []  # a sentence for each
        self.tracebacks: List[str] = []

    def tried(self, what: str, otherwise: T, function: Callable[..., T], *arguments: Any) -> T:
        """What a function returns, or `otherwise` if it raises an exception."""
        try:
            return function(*arguments)
        except Exception as error:
            self.told.append(f"the grader failed at {what}: {error!r}; its traceback is in {FILE}")
            self.tracebacks.append(f"{what}\n{traceback.format_exc()}")
            return otherwise


def changed_sources() -> str:
    """What follows an error's text if this program's sources, which are used in place, have changed since its start."""
    if any(path.is_file() and path.stat().st_mtime > STARTED for path in SOURCES.rglob("*.py")):
        return "; the sources of ./robocop have changed since it was started, as by git pull: start it again"
    return ""


def keep(tracebacks: Sequence[str], folder: Path) -> Path:
    """Write tracebacks to the file in the report's folder, and return its path."""
    (folder / FILE).write_text("\n".join(tracebacks), encoding="utf-8", errors="replace")
    return folder / FILE
