"""Folders and their files."""

import contextlib
import os
import subprocess
import tempfile
from pathlib import Path
from typing import Collection, Iterator, List, Tuple
from xml.etree import ElementTree

from .errors import HostingError

POINTER = b"version https://git-lfs"  # beginning of a file that stands for another one, which a server of Git LFS has
GENERATED = ("build", "devel", "install", "logs", "__pycache__", "__MACOSX")  # folders that nobody has written


def walk(top: Path, leave_out: Collection[str] = ()) -> Iterator[Tuple[Path, List[str], List[str]]]:
    """`top` and the folders below it, each with the names of folders and files in it, sorted.

    Links are files here, wherever they lead. A caller may remove names of folders to skip them. Folders that can't be
    read count as empty.
    """
    for path, folders, files in os.walk(top):
        links = {name for name in folders if os.path.islink(os.path.join(path, name))}
        folders[:] = sorted({*folders} - links - {*leave_out})
        yield Path(path), folders, sorted([*files, *links])


def remove(path: Path) -> None:
    """Remove a file, a link or a folder with all that is in it, if it exists; HostingError if that is not possible."""
    done = subprocess.run(["/bin/rm", "-rf", "--", str(path)], capture_output=True, stdin=subprocess.DEVNULL)
    if done.returncode != 0:
        raise HostingError(f"{path}: can't be removed: {done.stderr[-500:].decode(errors='replace').strip()}")


@contextlib.contextmanager
def temporary_folder(prefix: str) -> Iterator[Path]:
    """A new folder in TMPDIR, removed at the end."""
    folder = Path(tempfile.mkdtemp(prefix=prefix))
    try:
        yield folder
    finally:
        remove(folder)


def read_bytes(path: Path) -> bytes:
    """The content of a file; HostingError for one that can't be read, or is a pointer of Git LFS."""
    try:
        content = path.read_bytes()
    except OSError as error:
        raise HostingError(f"{path}: can't be read: {error.strerror}") from error
    if content.startswith(POINTER):
        raise HostingError(f"{path}: this is a pointer of Git LFS, the file itself was not handed in")
    return content


def read_text(path: Path) -> str:
    """The file as text; invalid UTF-8 is replaced."""
    return read_bytes(path).decode(errors="replace")


def read_xml(path: Path) -> ElementTree.Element:
    """The file's XML root; HostingError says where it is malformed."""
    try:
        return ElementTree.fromstring(read_bytes(path))
    except (ElementTree.ParseError, ValueError, LookupError) as error:  # the last two: encodings
        raise HostingError(f"{path}: not XML that can be read: {error}") from error
