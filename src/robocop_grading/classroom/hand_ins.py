"""Collects the hand-ins of a folder, each with a digest of its content, and packs one as bytes when it is graded."""

from dataclasses import dataclass, replace
from pathlib import Path
from typing import List, Tuple

from aro_robocop_goto_as.errors import GradingSetupError, RobocopError

from ..files import packing
from ..files.archives import is_archive

EXPECTED = "a folder, a zip or tar archive, or a Python file"
EXPORTED = ("submission_metadata.yml",)  # written by Gradescope itself into what it exports


@dataclass(frozen=True)
class HandIn:
    """A folder, archive or Python file, or a file that can't be graded, called as in the folder of the class."""

    name: str
    path: Path = Path()
    packed: bytes = b""  # a tar archive, empty until `pack`
    digest: str = ""
    problem: str = ""  # why it can't be packed
    notes: Tuple[str, ...] = ()  # about what is not used of it


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
            hand_ins.append(replace(pack(path), packed=b""))  # those of a large class don't fit into memory
    if not hand_ins:
        raise GradingSetupError(f"{folder}: no hand-ins: expected {EXPECTED} for each")
    return hand_ins, others


def pack(path: Path) -> HandIn:
    """The hand-in at a path, packed, or with the reason why it can't be."""
    is_file = path.is_file() and (path.suffix.lower() == ".py" or is_archive(path.name))
    if path.is_symlink() or not (path.is_dir() or is_file):
        kind = "a link" if path.is_symlink() else f"a {path.suffix or 'nameless'} file"
        return HandIn(path.name, path, problem=f"{kind}: expected {EXPECTED}")
    try:
        packed = packing.pack(path)
    except RobocopError as error:
        return HandIn(path.name, path, problem=str(error))
    except Exception as error:  # zipfile and tarfile document no list of exceptions for malformed files
        return HandIn(path.name, path, problem=f"can't be read: {error or type(error).__name__}")
    return HandIn(path.name, path, packed.archive, packed.digest, notes=tuple(packed.notes))


def unpack(hand_in: HandIn, folder: Path) -> Path:
    """Unpack to an empty folder; the path of the hand-in in it. SubmissionError if that is not possible."""
    packing.unpack(hand_in.packed, folder)
    return folder / hand_in.name
