"""A folder -> the hand-ins in it, each packed as bytes with a digest of its content."""

import hashlib
import io
import os
import stat
import tarfile
import zipfile
from dataclasses import dataclass
from pathlib import Path, PurePosixPath
from typing import IO, Iterator, List, Tuple

from ...errors import GradingError
from ...hosting.package import LEFT_OUT as NOT_WRITTEN

MOST = 64 * 1024 ** 2  # bytes of a hand-in
LEFT_OUT = {*NOT_WRITTEN, ".git", ".robocop", "__MACOSX"}
ZIP = ".zip"


@dataclass(frozen=True)
class HandIn:
    """What somebody handed in: a folder, a zip or a Python file, under the name it has in the class's folder."""

    name: str
    packed: bytes = b""  # a tar archive
    digest: str = ""
    problem: str = ""  # why it can't be taken


def collect(folder: Path) -> Tuple[List[HandIn], List[str]]:
    """Hand-ins by name, and the names of what is none. GradingError where there is not one."""
    if not folder.is_dir():
        raise GradingError(f"{folder}: expected a folder with one folder, zip or Python file for each who handed in")
    found, others = [], []
    for path in sorted(folder.iterdir()):
        if path.name.startswith("."):
            continue
        if path.is_symlink() or not (path.is_dir() or path.suffix.lower() in (".py", ZIP) and path.is_file()):
            others.append(path.name)
        else:
            found.append(_packed(path))
    if not found:
        raise GradingError(f"{folder}: nothing handed in: expected one folder, zip or Python file for each")
    return found, others


Entry = Tuple[str, int, bytes, str]  # name, mode as stat has it, content of a file, target of a link


def _packed(path: Path) -> HandIn:
    sums, buffer = hashlib.sha256(), io.BytesIO()
    try:
        with tarfile.open(fileobj=buffer, mode="w") as archive:
            for name, mode, content, target in _entries(path):
                info = tarfile.TarInfo(f"{path.name}/{name}" if name else path.name)
                info.mode, info.size, info.linkname = stat.S_IMODE(mode), len(content), target
                info.type = (tarfile.DIRTYPE if stat.S_ISDIR(mode) else tarfile.SYMTYPE if stat.S_ISLNK(mode)
                             else tarfile.REGTYPE)
                archive.addfile(info, io.BytesIO(content))
                sums.update(repr((name, mode, hashlib.sha256(content).digest(), target)).encode("utf-8", "replace"))
    except GradingError as error:
        return HandIn(path.name, problem=str(error))
    except Exception as error:  # zipfile and tarfile don't say what a broken or clever file makes them raise
        return HandIn(path.name, problem=f"can't be read: {error}")
    return HandIn(path.name, buffer.getvalue(), sums.hexdigest())


def _entries(path: Path) -> Iterator[Entry]:
    """Itself and all below it, in an order of their own. A folder with nothing but a zip in it is that zip."""
    if path.is_dir():
        inside = [it for it in path.iterdir() if not it.name.startswith(".")]
        if len(inside) == 1 and inside[0].suffix.lower() == ZIP and inside[0].is_file() and not inside[0].is_symlink():
            path = inside[0]
    return _zipped(path) if path.suffix.lower() == ZIP and path.is_file() else _on_disk(path)


def _on_disk(path: Path) -> Iterator[Entry]:
    """A file or folder and all below it, links as links."""
    left = MOST
    for inner, name in _walk(path):
        mode = os.lstat(inner).st_mode
        if not (stat.S_ISREG(mode) or stat.S_ISDIR(mode) or stat.S_ISLNK(mode)):
            raise GradingError(f"{name}: neither a file nor a folder nor a link")
        content = _at_most(open(inner, "rb"), left) if stat.S_ISREG(mode) else b""
        left -= len(content)
        yield name, mode, content, os.readlink(inner) if stat.S_ISLNK(mode) else ""


def _walk(path: Path) -> Iterator[Tuple[Path, str]]:
    yield path, ""
    if path.is_dir():
        for place, folders, files in os.walk(path):
            folders[:] = sorted(name for name in folders if name not in LEFT_OUT)
            for name in sorted([*folders, *files]):
                inner = Path(place, name)
                yield inner, str(inner.relative_to(path))


def _zipped(path: Path) -> Iterator[Entry]:
    """What is in a zip file, as a folder's content. It may claim anything, so it is read with care."""
    left = MOST
    yield "", stat.S_IFDIR | 0o755, b"", ""
    with zipfile.ZipFile(path) as archive:
        for entry in sorted(archive.infolist(), key=lambda it: it.filename):
            parts = PurePosixPath(entry.filename.replace("\\", "/")).parts  # Windows' own zips have backslashes
            if entry.is_dir() or not parts or LEFT_OUT.intersection(parts):
                continue
            if ".." in parts or parts[:1] == ("/",):
                raise GradingError(f"{entry.filename}: expected a path within the zip")
            content = _at_most(archive.open(entry), left)
            left -= len(content)
            executable = entry.external_attr >> 16 & 0o111
            yield str(PurePosixPath(*parts)), stat.S_IFREG | (0o755 if executable else 0o644), content, ""


def _at_most(source: "IO[bytes]", most: int) -> bytes:
    with source:
        content = source.read(most + 1)
    if len(content) > most:
        raise GradingError(f"larger than {MOST // 1024 ** 2} MB")
    return content


def unpack(hand_in: HandIn, folder: Path) -> Path:
    """Its files, below a folder of nobody else's; where they are."""
    with tarfile.open(fileobj=io.BytesIO(hand_in.packed)) as archive:
        archive.extractall(folder)
    return folder / hand_in.name
