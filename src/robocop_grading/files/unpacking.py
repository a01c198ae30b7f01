"""Unpacks what was handed in, on disk or in archives, one inside another, as the platforms of courses export it."""

import hashlib
import io
import os
import re
import stat
from pathlib import Path, PurePosixPath
from typing import Dict, List, NamedTuple

from robocop_hosting import tree

from ..errors import SubmissionError
from .archives import FOLDER, LEFT_OUT, Entries, Entry, is_archive, is_left_out, unpack_archive

MAX_NESTED = 3  # archives, one inside another, in what was handed in
MAX_NAMED = 10  # files in a message
# What is graded, also under a browser's name of a second download. Archives beside it stay as they are.
GRADED = re.compile(r"package\.xml|robocop_(goto_as|rviz_goto_ac).*\.py")
OTHER_ARCHIVES = (".rar", ".7z", ".gz", ".bz2", ".xz", ".zst")
TYPES = (stat.S_IFREG, stat.S_IFDIR, stat.S_IFLNK)


class Unpacked(NamedTuple):
    """What was handed in, a file or a folder, in memory."""

    entries: Dict[str, Entry]  # by path; the file or folder itself has an empty one
    notes: List[str]  # about what is not used

    @property
    def digest(self) -> str:
        """A text that changes with the content."""
        sums = hashlib.sha256()
        for path, (mode, content, target) in sorted(self.entries.items()):
            sums.update(repr((path, mode, hashlib.sha256(content).digest(), target)).encode("utf-8", "replace"))
        return sums.hexdigest()

    def write(self, top: Path) -> None:
        """Write it to `top`, which does not exist yet; SubmissionError if that is not possible."""
        try:
            for path, (mode, content, target) in sorted(self.entries.items()):
                place = top / path if path else top
                folder = place if stat.S_ISDIR(mode) else place.parent
                folder.mkdir(parents=True, exist_ok=True)
                if stat.S_ISLNK(mode):
                    place.symlink_to(target)
                elif stat.S_ISREG(mode):
                    place.write_bytes(content)
                    place.chmod(stat.S_IMODE(mode))
        except (OSError, ValueError) as error:  # for example a name that is too long, or a link to one with a zero byte
            raise SubmissionError(f"can't be unpacked: {error}") from error


def unpack(path: Path) -> Unpacked:
    """Unpack a file, archive or folder; SubmissionError if it can't be read, or has nothing to grade."""
    entries = Entries()
    try:
        if is_archive(path.name) and path.is_file():
            entries.add("", Entry(FOLDER))
            with open(path, "rb") as file:
                unpack_archive(file, entries)
        else:
            _add_from_disk(path, entries)
        if path.is_dir() and not os.listdir(path):
            raise SubmissionError("the folder is empty")
    except OSError as error:
        raise SubmissionError(f"can't be read: {error}") from error
    _unpack_nested(entries)
    notes = [f"{it} was left out: a video, a recording or an image is not graded" for it in entries.left_out]
    return Unpacked(entries.by_path, [*_notes(entries.by_path), *notes])


def is_packed(path: Path) -> bool:
    """Return whether a path is an archive, or a folder with archives and nothing to grade outside of them."""
    if not path.is_dir():
        return path.is_file() and is_archive(path.name)
    names = [name for _, _, files in tree.walk(path, LEFT_OUT) for name in files]
    return any(map(is_archive, names)) and not any(map(GRADED.fullmatch, names))


def _add_from_disk(path: Path, entries: Entries) -> None:
    """A file or folder and everything below it; links are not followed."""
    below = (folder / name for folder, folders, files in tree.walk(path, LEFT_OUT) for name in [*folders, *files])
    for inner in (path, *below):
        name, status = "" if inner == path else inner.relative_to(path).as_posix(), os.lstat(inner)
        mode = status.st_mode
        if stat.S_IFMT(mode) not in TYPES:
            raise SubmissionError(f"{name}: expected a file, folder or link")
        if is_left_out(PurePosixPath(name)):
            continue
        if stat.S_ISREG(mode):
            entries.add_file(name, mode, open(inner, "rb"), status.st_size)
        else:
            entries.add(name, Entry(mode, target=os.readlink(inner) if stat.S_ISLNK(mode) else ""))


def _unpack_nested(entries: Entries) -> None:
    """Replace archives by folders with their names, until there is something to grade outside of archives."""
    for _ in range(MAX_NESTED):
        archives = [path for path in _files(entries.by_path) if is_archive(path)]
        if _has_something_to_grade(entries.by_path):
            return
        for path in archives:
            try:
                unpack_archive(io.BytesIO(entries.by_path.pop(path).content), entries, path)
            except SubmissionError as error:
                raise SubmissionError(f"{path}: {error}") from error


def _files(entries: Dict[str, Entry]) -> List[str]:
    return [path for path in sorted(entries) if path and stat.S_ISREG(entries[path].mode)]


def _has_something_to_grade(entries: Dict[str, Entry]) -> bool:
    return any(GRADED.fullmatch(PurePosixPath(path).name) for path in entries)


def _notes(entries: Dict[str, Entry]) -> List[str]:
    """Notes about archives that were not unpacked; SubmissionError if there is nothing to grade."""
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
        raise SubmissionError("; ".join([problem, *notes]))
    return notes
