"""Unpacks what was handed in, with the archives in it, one inside another; done in the sandbox."""

import os
import re
import signal
import stat
import subprocess
from pathlib import Path
from typing import IO, List

from robocop_hosting import tree

from ..errors import GradingError
from ..sandbox.limits import MB
from .exports import is_archive
from .packing import LEFT_OUT

MAX_NESTED = 3  # archives, one inside another, in what was handed in
MAX_NAMED = 10  # files in a message
# What is graded, also under a browser's name of a second download. Archives beside it stay as they are.
GRADED = re.compile(r"package\.xml|robocop_(goto_as|rviz_goto_ac).*\.py")
COMPRESSED = (".gz", ".bz2", ".xz", ".zst")
NOT_EMPTY = " "  # a passphrase: bsdtar would ask for one
FULL = "No space left on device"


def unpack(packed: "IO[bytes]", top: Path) -> List[str]:
    """Unpack a hand-in into a new folder; return notes about what is not used.

    GradingError if that is not possible, or if there is nothing to grade.
    """
    top.mkdir(parents=True)
    _extract(packed, top, top)
    for _ in range(MAX_NESTED):
        if _has_something_to_grade(top):
            break
        for path in filter(is_archive, _files(top)):
            archive = path.rename(path.with_name(f"{path.name}.packed"))
            path.mkdir()
            with open(archive, "rb") as file:
                _extract(file, path, top)
            archive.unlink()
    return _notes(top)


def _extract(packed: "IO[bytes]", folder: Path, top: Path) -> None:
    """Unpack an archive in a folder below `top`: bsdtar writes nothing above the folder, nor through a link."""
    options = ["--no-same-owner", "--no-same-permissions", "--passphrase", NOT_EMPTY]
    command = ["bsdtar", "-x", "-f", "-", *options, *(f"--exclude={it}" for it in LEFT_OUT), "-C", str(folder)]
    done = subprocess.run(command, stdin=packed, capture_output=True, env={**os.environ, "LC_ALL": "C.UTF-8"})
    subprocess.run(["chmod", "-R", "a+rX,u+w", str(top)], check=True)
    if done.returncode != 0:
        told, name = done.stderr.decode(errors="replace"), str(folder.relative_to(top))
        if FULL in told or done.returncode == -signal.SIGXFSZ:
            largest = max(_files(top), key=lambda it: it.lstat().st_size)
            size = largest.lstat().st_size / MB
            raise GradingError(f"{name}: too large; the largest file in it is {largest.name} with {size:.1f} MB")
        raise GradingError(f"{name}: can't be unpacked: {told.splitlines()[0].replace('bsdtar: ', '')}")
    for parent, folders, files in os.walk(folder, topdown=False):
        for name in (*folders, *files):
            _tidy(Path(parent, name))


def _tidy(path: Path) -> None:
    """Give a file the name that its author saw, or remove it if it is a pipe or the like."""
    kind = path.lstat().st_mode
    if not (stat.S_ISREG(kind) or stat.S_ISDIR(kind) or stat.S_ISLNK(kind)):
        path.unlink()
        return
    name = os.fsencode(path.name)
    try:
        name.decode()
    except UnicodeDecodeError:  # in a zip of a Czech Windows
        path.rename(path.with_name(name.decode("cp852")))


def _files_and_links(top: Path) -> List[Path]:
    return sorted(folder / name for folder, _, names in tree.walk(top) for name in names)


def _files(top: Path) -> List[Path]:
    return [it for it in _files_and_links(top) if it.is_file() and not it.is_symlink()]


def _has_something_to_grade(top: Path) -> bool:
    return any(GRADED.fullmatch(it.name) for it in _files(top))


def _notes(top: Path) -> List[str]:
    """Notes about archives that were not unpacked, and links; GradingError if there is nothing to grade."""
    files = {it: str(it.relative_to(top)) for it in _files(top)}
    reason = "what is graded is outside of it" if _has_something_to_grade(top) else "more than three in one another"
    notes = [f"{name} was not unpacked: {reason}" for path, name in files.items() if is_archive(path)]
    others = [name for name in files.values() if name.lower().endswith(COMPRESSED) and not is_archive(Path(name))]
    notes += [f"{name} was not unpacked: it is no archive" for name in others]
    lost = [it for it in _files_and_links(top) if it.is_symlink() and not it.exists() and it.name[0] != "."]
    remedy = "which was not handed in: put the file itself in its place"
    notes += [f"{it.relative_to(top)} is a link to {os.readlink(it)}, {remedy}" for it in lost]
    is_single = len(files) == 1 and next(iter(files)).parent == top
    if not is_single and not any(name.endswith((".py", "package.xml")) for name in files.values()):
        shown = ", ".join([*files.values()][:MAX_NAMED]) + (" ..." if len(files) > MAX_NAMED else "")
        nothing = "no file in it, but for build products, videos and the like"
        problem = f"no package and no Python file in it, only {shown}" if files else nothing
        raise GradingError("; ".join([problem, *notes]))
    return notes
