"""A folder -> the hand-ins in it, each packed as bytes with a digest of its content."""

import hashlib
import io
import os
import stat
import tarfile
from dataclasses import dataclass
from pathlib import Path
from typing import Iterator, List, Tuple

from ...errors import GradingError

MOST = 64 * 1024 ** 2  # bytes of a hand-in
LEFT_OUT = {".git", "__pycache__", "build", "devel", "install", "logs", ".robocop"}


@dataclass(frozen=True)
class HandIn:
    """What somebody handed in: a folder or a Python file, under the name it has in the class's folder."""

    name: str
    packed: bytes = b""  # a tar archive
    digest: str = ""
    problem: str = ""  # why it can't be taken


def collect(folder: Path) -> Tuple[List[HandIn], List[str]]:
    """Hand-ins by name, and the names of what is none. GradingError where there is not one."""
    if not folder.is_dir():
        raise GradingError(f"{folder}: expected a folder with one folder or Python file for each who handed in")
    found, others = [], []
    for path in sorted(folder.iterdir()):
        if path.name.startswith("."):
            continue
        if path.is_symlink() or not (path.is_dir() or path.suffix == ".py" and path.is_file()):
            others.append(path.name)
        else:
            found.append(_packed(path))
    if not found:
        raise GradingError(f"{folder}: no folder and no Python file in it; expected one for each who handed in")
    return found, others


def _packed(path: Path) -> HandIn:
    sums, total, buffer = hashlib.sha256(), 0, io.BytesIO()
    try:
        with tarfile.open(fileobj=buffer, mode="w") as archive:
            for inner, name in _entries(path):
                mode = os.lstat(inner).st_mode
                if not (stat.S_ISREG(mode) or stat.S_ISDIR(mode) or stat.S_ISLNK(mode)):
                    return HandIn(path.name, problem=f"{name}: neither a file nor a folder nor a link")
                total += os.lstat(inner).st_size
                if total > MOST:
                    return HandIn(path.name, problem=f"larger than {MOST // 1024 ** 2} MB")
                info = archive.gettarinfo(str(inner), name)
                info.uid = info.gid = 0
                info.uname = info.gname = ""
                info.type = tarfile.REGTYPE if info.islnk() else info.type  # a second name for a file is a file
                info.size = os.lstat(inner).st_size if info.isreg() else 0
                sums.update(repr((name, info.mode, info.type, info.linkname if info.issym() else "")).encode())
                if info.isreg():
                    content = inner.read_bytes()[:info.size]
                    sums.update(hashlib.sha256(content).digest())
                    archive.addfile(info, io.BytesIO(content))
                else:
                    archive.addfile(info)
    except OSError as error:
        return HandIn(path.name, problem=f"can't be read: {error}")
    return HandIn(path.name, buffer.getvalue(), sums.hexdigest())


def _entries(path: Path) -> Iterator[Tuple[Path, str]]:
    """A file or folder and all below it, links as links, in an order of their own: path, name in the archive."""
    yield path, path.name
    if path.is_dir():
        for place, folders, files in os.walk(path):
            folders[:] = sorted(name for name in folders if name not in LEFT_OUT)
            for name in sorted([*folders, *files]):
                inner = Path(place, name)
                yield inner, f"{path.name}/{inner.relative_to(path)}"


def unpack(hand_in: HandIn, folder: Path) -> Path:
    """Its files, below a folder of nobody else's; where they are."""
    with tarfile.open(fileobj=io.BytesIO(hand_in.packed)) as archive:
        archive.extractall(folder)
    return folder / hand_in.name
