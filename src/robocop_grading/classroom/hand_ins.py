"""Collects the hand-ins of a folder, each with a digest of its content."""

from dataclasses import dataclass
from pathlib import Path
from typing import List, Tuple

from aro_robocop_goto_as.errors import GradingSetupError, RobocopError, SubmissionError

from ..files import unpacking
from ..files.archives import is_archive

EXPECTED = "a folder, a zip or tar archive, or a Python file"
EXPORTED = ("submission_metadata.yml",)  # written by Gradescope itself into what it exports


@dataclass(frozen=True)
class HandIn:
    """A folder, archive or Python file; without a digest, it can't be read."""

    path: Path
    digest: str

    @property
    def name(self) -> str:
        """Its name in the folder of the class."""
        return self.path.name


def collect(folder: Path, reserved: Tuple[str, ...] = ()) -> Tuple[List[HandIn], List[str]]:
    """The hand-ins sorted by name: whatever is not hidden, except files that are `reserved` or made by the platform.

    With the names of those. GradingSetupError if there is no hand-in.
    """
    if not folder.is_dir():
        raise GradingSetupError(f"{folder}: expected a folder with {EXPECTED} for each hand-in")
    hand_ins, others = [], []
    for path in sorted(folder.iterdir()):
        if path.name in (*reserved, *EXPORTED) and path.is_file():
            others.append(path.name)
        elif not path.name.startswith(".") and path.name != "__MACOSX":
            hand_ins.append(HandIn(path, _digest(path)))
    if not hand_ins:
        raise GradingSetupError(f"{folder}: no hand-ins: expected {EXPECTED} for each")
    return hand_ins, others


def _digest(path: Path) -> str:
    try:
        return unpacked(path).digest
    except RobocopError:  # its row says why
        return ""


def unpacked(path: Path) -> unpacking.Unpacked:
    """What was handed in; SubmissionError if that can't be graded, or read."""
    is_file = path.is_file() and (path.suffix.lower() == ".py" or is_archive(path.name))
    if path.is_symlink() or not (path.is_dir() or is_file):
        kind = "a link" if path.is_symlink() else f"a {path.suffix or 'nameless'} file"
        raise SubmissionError(f"{kind}: expected {EXPECTED}")
    try:
        return unpacking.unpack(path)
    except RobocopError:
        raise
    except Exception as error:  # zipfile and tarfile document no list of exceptions for malformed files
        raise SubmissionError(f"can't be read: {error or type(error).__name__}") from error
