"""Other people's folders, however deep they are nested, and their files, which may be pipes, devices, or too large.

os.walk, shutil.rmtree and Path.rglob call themselves for each level, and Python ends a program at 1,000 levels; so
walk() gives up at a lower number of levels, and remove() starts another program that removes the folder.
"""

import contextlib
import os
import stat
import subprocess
import tempfile
from pathlib import Path
from typing import Collection, Iterator, List, Optional, Tuple
from xml.etree import ElementTree

from .errors import HostingError

MAX_SIZE = 1024**2  # bytes of a manifest, launch file or script
POINTER = b"version https://git-lfs"  # beginning of a file that stands for another one, which a server of Git LFS has
IS_POINTER = "this is a pointer of Git LFS, the file itself was not handed in"
GENERATED = ("build", "devel", "install", "logs", "__pycache__", "__MACOSX")  # folders that nobody has written
MAX_DEPTH = 100  # nested folders; packages and their builds have ten or so


def walk(top: Path, leave_out: Collection[str] = ()) -> Iterator[Tuple[Path, List[str], List[str]]]:
    """`top` and the folders below it, each with the names of folders and files in it, sorted.

    Links are files here, wherever they lead. A caller may remove names of folders to skip them. Folders that can't be
    read count as empty. HostingError for more than MAX_DEPTH nested folders.
    """
    for path, folders, files in os.walk(top):
        if len(Path(path).relative_to(top).parts) > MAX_DEPTH:
            raise HostingError(f"{top}: expected at most {MAX_DEPTH} nested folders")
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


def read_bytes(path: Path, top: Optional[Path] = None) -> bytes:
    """The content of a regular file; HostingError for a pipe, a device, a pointer of Git LFS, or more than a megabyte.

    With `top`, the file also has to be inside that folder after all links in its path are followed.
    """
    real = Path(os.path.realpath(path))
    if top is not None and Path(os.path.realpath(top)) not in real.parents:
        raise HostingError(f"{path}: expected an ordinary file, not a link to one elsewhere")
    try:
        if not stat.S_ISREG(os.stat(real).st_mode):  # opening a device can have effects by itself
            raise HostingError(f"{path}: expected an ordinary file")
        with open(os.open(real, os.O_RDONLY | os.O_NONBLOCK | os.O_NOFOLLOW), "rb") as file:
            content = file.read(MAX_SIZE + 1)
    except OSError as error:
        raise HostingError(f"{path}: can't be read, expected an ordinary file: {error.strerror}") from error
    if len(content) > MAX_SIZE:
        raise HostingError(f"{path}: expected less than {MAX_SIZE // 1024} kB")
    if content.startswith(POINTER):
        raise HostingError(f"{path}: {IS_POINTER}")
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
