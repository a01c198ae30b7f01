"""Collects the hand-ins of a folder, each with a digest of its content."""

import contextlib
from pathlib import Path
from typing import Collection, Dict, List, Tuple

from aro_robocop_goto_as.errors import RobocopError
from robocop_hosting.tree import temporary_folder

from ..errors import GradingError, GradingSetupError
from ..files.exports import EXPECTED, METADATA, ONLINE_TEXT, hand_in_of, is_archive, parts_of, visible
from ..files.packing import pack


def collect(folder: Path, reserved: Collection[str] = ()) -> Tuple[Dict[str, str], List[str]]:
    """The digests of hand-ins by their names, sorted; a hand-in that can't be read has an empty digest.

    Every entry that is not hidden is a hand-in, or a part of one, except files that are `reserved` or made by the
    platform. The second value has the names of these files. GradingSetupError if there is no hand-in.
    """
    hand_ins: Dict[str, str] = {}
    others = []
    for path in visible(folder):
        name = hand_in_of(path.name)
        if (path.name in (*reserved, METADATA) and path.is_file()) or ONLINE_TEXT in path.name:
            others.append(path.name)
        elif name not in hand_ins:
            hand_ins[name] = ""
            with contextlib.suppress(RobocopError), temporary_folder("robocop-digest-") as work:  # its row says why not
                hand_ins[name] = pack(entries_of(folder / name), work / "hand_in.tar")
    if not hand_ins:
        raise GradingSetupError(f"{folder}: no hand-ins: expected {EXPECTED} for each")
    return hand_ins, others


def entries_of(path: Path) -> List[Path]:
    """What a hand-in consists of; GradingError if it can't be graded."""
    parts = parts_of(path)
    is_file = path.is_file() and (path.suffix.lower() == ".py" or is_archive(path))
    if any(it.is_symlink() for it in (path, *parts)) or not (parts or path.is_dir() or is_file):
        kind = (
            "a link"
            if path.is_symlink() or parts
            else f"a {path.suffix} file"
            if path.suffix
            else "a file without a suffix"
        )
        raise GradingError(f"{kind}: expected {EXPECTED}")
    return parts or [path]
