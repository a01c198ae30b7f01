"""Unpacks what was handed in, on disk or in archives, one inside another, as the platforms of courses export it."""

import io
import os
import re
import stat
from pathlib import Path, PurePosixPath
from types import MappingProxyType
from typing import Dict, List, Mapping

from robocop_hosting import tree

from ..errors import GradingError
from .archives import FOLDER, LEFT_OUT, Entry, Unpacked, file_mode, is_archive, is_left_out, unpack_archive

MAX_NESTED = 3  # archives, one inside another, in what was handed in
MAX_NAMED = 10  # files in a message
# What is graded, also under a browser's name of a second download. Archives beside it stay as they are.
GRADED = re.compile(r"package\.xml|robocop_(goto_as|rviz_goto_ac).*\.py")
OTHER_ARCHIVES = (".rar", ".7z", ".gz", ".bz2", ".xz", ".zst")
TYPES = (stat.S_IFREG, stat.S_IFDIR, stat.S_IFLNK)


def unpack(path: Path, parts: Mapping[str, Path] = MappingProxyType({})) -> Unpacked:
    """Unpack a file, archive or folder; GradingError if it can't be read, or has nothing to grade.

    With `parts`, unpack a folder that consists of these: files by their names, and the content of a folder.
    """
    found = Unpacked()
    try:
        if parts:
            found.add("", Entry(FOLDER))
            for name, part in parts.items():
                _add_from_disk(part, found, name)
        elif is_archive(path.name) and path.is_file():
            found.add("", Entry(FOLDER))
            with open(path, "rb") as file:
                unpack_archive(file, found)
        else:
            _add_from_disk(path, found)
        if not any(it.is_file() or os.listdir(it) for it in parts.values() or [path]):
            raise GradingError("the folder is empty")
    except OSError as error:
        raise GradingError(f"can't be read: {error}") from error
    _unpack_nested(found)
    found.notes = [*_notes(found.entries), *found.notes]
    return found


def is_packed(path: Path) -> bool:
    """Return whether a path is an archive, or a folder with archives and nothing to grade outside of them."""
    if not path.is_dir():
        return path.is_file() and is_archive(path.name)
    names = [name for _, _, files in tree.walk(path, LEFT_OUT) for name in files]
    return any(map(is_archive, names)) and not any(map(GRADED.fullmatch, names))


def _add_from_disk(path: Path, found: Unpacked, top: str = "") -> None:
    """A file or folder, called `top`, and everything below it; links are not followed."""
    below = (folder / name for folder, folders, files in tree.walk(path, LEFT_OUT) for name in [*folders, *files])
    for inner in (path, *below):
        name, status = top if inner == path else str(PurePosixPath(top, inner.relative_to(path))), os.lstat(inner)
        mode = status.st_mode
        if stat.S_IFMT(mode) not in TYPES:
            raise GradingError(f"{name}: expected a file, folder or link")
        if is_left_out(PurePosixPath(name)):
            continue
        if stat.S_ISREG(mode):
            found.add_file(name, file_mode(mode), open(inner, "rb"), status.st_size)
        else:
            found.add(name, Entry(mode, target=os.readlink(inner) if stat.S_ISLNK(mode) else ""))


def _unpack_nested(found: Unpacked) -> None:
    """Replace archives by folders with their names, until there is something to grade outside of archives."""
    for _ in range(MAX_NESTED):
        archives = [path for path in _files(found.entries) if is_archive(path)]
        if _has_something_to_grade(found.entries):
            return
        for path in archives:
            try:
                unpack_archive(io.BytesIO(found.entries.pop(path).content), found, path)
            except GradingError as error:
                raise GradingError(f"{path}: {error}") from error


def _files(entries: Dict[str, Entry]) -> List[str]:
    return [path for path in sorted(entries) if path and stat.S_ISREG(entries[path].mode)]


def _has_something_to_grade(entries: Dict[str, Entry]) -> bool:
    return any(GRADED.fullmatch(PurePosixPath(path).name) for path in entries)


def _notes(entries: Dict[str, Entry]) -> List[str]:
    """Notes about archives that were not unpacked; GradingError if there is nothing to grade."""
    files = _files(entries)
    reason = "what is graded is outside of it" if _has_something_to_grade(entries) else "more than three in one another"
    notes = [f"{path} was not unpacked: {reason}" for path in files if is_archive(path)]
    others = [path for path in files if path.lower().endswith(OTHER_ARCHIVES) and not is_archive(path)]
    notes += [f"{path} was not unpacked: expected zip or tar" for path in others]
    if stat.S_ISDIR(entries[""].mode) and not any(path.endswith((".py", "package.xml")) for path in files):
        found = ", ".join(files[:MAX_NAMED]) + (" ..." if len(files) > MAX_NAMED else "")
        problem = (
            f"no package and no Python file in it, only {found}" if files else "no file in it, but for build products"
        )
        raise GradingError("; ".join([problem, *notes]))
    return notes
