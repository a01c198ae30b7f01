"""Exceptions in judging: each costs an explanation, never a grade, and leaves its traceback in the report's folder."""

import traceback
from pathlib import Path
from typing import Any, Callable, List, Sequence, TypeVar

FILE = "traceback.txt"  # in the report's folder
T = TypeVar("T")


class Faults:
    """The exceptions of one grading."""

    def __init__(self) -> None:
        self.problems: List[str] = []  # a sentence for each
        self.tracebacks: List[str] = []

    def tried(self, what: str, otherwise: T, function: Callable[..., T], *arguments: Any) -> T:
        """What a function returns, or `otherwise` if it raises an exception."""
        try:
            return function(*arguments)
        except Exception as error:
            self.problems.append(f"the grader failed at {what}: {error!r}; its traceback is in {FILE}")
            self.tracebacks.append(f"{what}\n{traceback.format_exc()}")
            return otherwise


def keep(tracebacks: Sequence[str], folder: Path) -> Path:
    """Write tracebacks to the file in the report's folder, and return its path."""
    (folder / FILE).write_text("\n".join(tracebacks), encoding="utf-8", errors="replace")
    return folder / FILE
