"""Collects the hand-ins of a folder, each with a digest of its content, and packs one as bytes when it is graded."""

import hashlib
import io
import itertools
import os
import stat
import tarfile
import zipfile
from dataclasses import dataclass, replace
from pathlib import Path, PurePosixPath
from typing import IO, Any, Dict, Iterator, List, Tuple

from aro_robocop_goto_as.errors import GradingSetupError, SubmissionError

from ..hosting import tree
from ..hosting.package import GENERATED as BUILD_PRODUCTS

MOST_BYTES = 64 * 1024**2  # of a hand-in
MOST_ENTRIES = 5_000  # files, folders and links of a hand-in
MOST_DIRECTORY = 4 * 1024**2  # bytes of a zip's list of its entries, which zipfile reads at once
TOO_MANY = f"expected at most {MOST_ENTRIES} files and folders"
LEFT_OUT = {*BUILD_PRODUCTS, ".git", ".robocop", "__MACOSX"}
ZIP = ".zip"
TYPES = {stat.S_IFREG: tarfile.REGTYPE, stat.S_IFDIR: tarfile.DIRTYPE, stat.S_IFLNK: tarfile.SYMTYPE}
DIRECTORY_SIZE = 5  # index in zipfile's record of a zip's end


@dataclass(frozen=True)
class HandIn:
    """A folder, zip or Python file, called as in the folder of the class."""

    name: str
    path: Path = Path()
    packed: bytes = b""  # a tar archive, empty until `pack`
    digest: str = ""
    problem: str = ""  # why it can't be packed


def collect(folder: Path) -> Tuple[List[HandIn], List[str]]:
    """The hand-ins sorted by name, and the names of other files; GradingSetupError if there is no hand-in."""
    if not folder.is_dir():
        raise GradingSetupError(f"{folder}: expected a folder with one folder, zip or Python file for each hand-in")
    hand_ins, others = [], []
    for path in sorted(folder.iterdir()):
        if path.name.startswith("."):
            continue
        if path.is_symlink() or not (path.is_dir() or path.suffix.lower() in (".py", ZIP) and path.is_file()):
            others.append(path.name)
        else:
            hand_ins.append(replace(pack(path), packed=b""))  # those of a large class don't fit into memory
    if not hand_ins:
        raise GradingSetupError(f"{folder}: no hand-ins: expected one folder, zip or Python file for each")
    return hand_ins, others


Entry = Tuple[str, int, bytes, str]  # name, st_mode, content of a file, target of a link


def pack(path: Path) -> HandIn:
    """The hand-in at a path, packed, or with the reason why it can't be."""
    sums, buffer = hashlib.sha256(), io.BytesIO()
    try:
        with tarfile.open(fileobj=buffer, mode="w") as archive:
            for number, (name, mode, content, target) in enumerate(_entries(path)):
                if number > MOST_ENTRIES:
                    raise SubmissionError(TOO_MANY)
                info = tarfile.TarInfo(f"{path.name}/{name}" if name else path.name)
                info.mode, info.size, info.linkname = stat.S_IMODE(mode), len(content), target
                info.type = TYPES[stat.S_IFMT(mode)]
                archive.addfile(info, io.BytesIO(content))
                sums.update(repr((name, mode, hashlib.sha256(content).digest(), target)).encode("utf-8", "replace"))
    except SubmissionError as error:
        return HandIn(path.name, path, problem=str(error))
    except Exception as error:  # zipfile and tarfile document no list of exceptions for malformed files
        return HandIn(path.name, path, problem=f"can't be read: {error}")
    return HandIn(path.name, path, buffer.getvalue(), sums.hexdigest())


def _entries(path: Path) -> Iterator[Entry]:
    """The path and everything below it in a fixed order; a folder that contains only a zip counts as the zip."""
    if path.is_dir():
        inside = [entry for entry in path.iterdir() if not entry.name.startswith(".")]
        if len(inside) == 1 and inside[0].suffix.lower() == ZIP and inside[0].is_file() and not inside[0].is_symlink():
            path = inside[0]
    return _zipped(path) if path.suffix.lower() == ZIP and path.is_file() else _on_disk(path)


def _on_disk(path: Path) -> Iterator[Entry]:
    """A file or folder and everything below it; links are not followed."""
    left = MOST_BYTES
    levels = tree.walk(path, LEFT_OUT)
    below = (folder / name for folder, folders, files in levels for name in sorted([*folders, *files]))
    for inner in itertools.chain([path], below):
        name = "" if inner == path else str(inner.relative_to(path))
        mode = os.lstat(inner).st_mode
        if stat.S_IFMT(mode) not in TYPES:
            raise SubmissionError(f"{name}: expected a file, folder or link")
        content = _at_most(open(inner, "rb"), left) if stat.S_ISREG(mode) else b""
        left -= len(content)
        yield name, mode, content, os.readlink(inner) if stat.S_ISLNK(mode) else ""


def _zipped(path: Path) -> Iterator[Entry]:
    """The contents of a zip file as a folder; neither its paths nor its sizes are trusted."""
    left = MOST_BYTES
    yield "", stat.S_IFDIR | 0o755, b"", ""
    with open(path, "rb") as file:
        end = zipfile._EndRecData(file)  # type: ignore[attr-defined]  # private: nothing public reads only this
    if end and end[DIRECTORY_SIZE] > MOST_DIRECTORY:
        raise SubmissionError(TOO_MANY)
    with zipfile.ZipFile(path) as archive:
        for entry in sorted(archive.infolist(), key=lambda entry: entry.filename):
            parts = PurePosixPath(entry.filename.replace("\\", "/")).parts  # zips made by Windows have backslashes
            if entry.is_dir() or not parts or LEFT_OUT.intersection(parts):
                continue
            if ".." in parts or parts[:1] == ("/",):
                raise SubmissionError(f"{entry.filename}: expected a path within the zip")
            if len(parts) > tree.DEEPEST:
                raise SubmissionError(f"expected at most {tree.DEEPEST} nested folders")
            content = _at_most(archive.open(entry), left)
            left -= len(content)
            executable = entry.external_attr >> 16 & 0o111
            yield str(PurePosixPath(*parts)), stat.S_IFREG | (0o755 if executable else 0o644), content, ""


def _at_most(source: "IO[bytes]", most: int) -> bytes:
    with source:
        content = source.read(most + 1)
    if len(content) > most:
        raise SubmissionError(f"larger than {MOST_BYTES // 1024**2} MB")
    return content


def unpack(hand_in: HandIn, folder: Path) -> Path:
    """Unpack to an empty folder; the path of the hand-in in it. SubmissionError if that is not possible."""
    # Packed by pack(), from checked names. Python 3.14's default would refuse some links and change modes.
    options: Dict[str, Any] = {"filter": "fully_trusted"} if hasattr(tarfile, "data_filter") else {}
    try:
        with tarfile.open(fileobj=io.BytesIO(hand_in.packed)) as archive:
            archive.extractall(folder, **options)
    except (OSError, tarfile.TarError) as error:  # for example one name for a file and a folder
        raise SubmissionError(f"can't be unpacked: {error}") from error
    return folder / hand_in.name
