"""Collects the hand-ins of a folder, each with a digest of its content."""

import contextlib
from pathlib import Path
from typing import Collection, Dict, List, Tuple

from aro_robocop_goto_as.errors import RobocopError

from ..errors import GradingError, GradingSetupError
from ..files import unpacking
from ..files.archives import Unpacked, is_archive
from ..files.exports import EXPECTED, METADATA, visible


def collect(folder: Path, reserved: Collection[str] = ()) -> Tuple[Dict[str, str], List[str]]:
    """The digests of hand-ins by their names, sorted; a hand-in that can't be read has an empty digest.

    Every entry that is not hidden is a hand-in, except files that are `reserved` or made by the platform. The second
    value has the names of these files. GradingSetupError if there is no hand-in.
    """
    hand_ins: Dict[str, str] = {}
    others = []
    for path in visible(folder):
        if path.name in (*reserved, METADATA) and path.is_file():
            others.append(path.name)
        else:
            hand_ins[path.name] = ""
            with contextlib.suppress(RobocopError):  # its row says why
                hand_ins[path.name] = unpacked(path).digest
    if not hand_ins:
        raise GradingSetupError(f"{folder}: no hand-ins: expected {EXPECTED} for each")
    return hand_ins, others


def unpacked(path: Path) -> Unpacked:
    """The files of a hand-in; GradingError if the hand-in can't be graded, or read."""
    is_file = path.is_file() and (path.suffix.lower() == ".py" or is_archive(path.name))
    if path.is_symlink() or not (path.is_dir() or is_file):
        kind = "a link" if path.is_symlink() else f"a {path.suffix} file" if path.suffix else "a file without a suffix"
        raise GradingError(f"{kind}: expected {EXPECTED}")
    return unpacking.unpack(path)
