"""What zip and tar archives contain, read in memory; neither their paths nor their sizes are trusted.

Members are read one by one, and nothing is extracted, so that all Pythons do the same: the filters of
tarfile.extractall() came with 3.12, and 3.14 changed the default one.
"""

import bz2
import gzip
import hashlib
import io
import lzma
import os
import stat
import tarfile
import zipfile
from pathlib import Path, PurePosixPath
from typing import IO, Any, Callable, Dict, List, NamedTuple

from robocop_hosting import tree

from ..errors import GradingError

MB = 1024**2
MAX_BYTES = 64 * MB  # of a hand-in, without its archives
MAX_ENTRIES = 5_000  # files, folders and links of a hand-in
MAX_PACKED = 256 * MB  # bytes of a hand-in's archives, and of a tar archive with what is left out
MAX_TARGET = 4096  # bytes of a link's target in a zip, as Linux takes it
MAX_UNGRADED = MB  # bytes of a file in UNGRADED; a larger one is left out
MAX_DIRECTORY = 4 * MB  # bytes of a zip's list of its entries, which zipfile reads at once
TOO_MANY = f"expected at most {MAX_ENTRIES} files and folders"
LEFT_OUT = {*tree.GENERATED, ".git", ".robocop", ".ipynb_checkpoints", ".DS_Store"}
UNGRADED = frozenset(  # videos, recordings and images
    ".avi .bag .bmp .gif .heic .jpeg .jpg .m4v .mkv .mov .mp4 .mpeg .mpg .ogv .pdf .png .tif .tiff .webm .wmv".split()
)
NOT_GRADED = "was left out: a video, a recording or an image is not graded"
APPLE_DOUBLE = "._"  # beginning of the files in which macOS keeps attributes of others
SUFFIXES = (".zip", ".tar", ".tar.gz", ".tgz", ".tar.bz2", ".tbz2", ".tar.xz", ".txz")
# By a file's first bytes.
COMPRESSIONS: Dict[bytes, Callable[..., Any]] = {b"\x1f\x8b": gzip.open, b"BZh": bz2.open, b"\xfd7zXZ\0": lzma.open}
DIRECTORY_SIZE = 5  # index in zipfile's record of a zip's end
UTF_8 = 0x800  # flag of a zip's entry
LINK, FOLDER = stat.S_IFLNK | 0o777, stat.S_IFDIR | 0o755


class Entry(NamedTuple):
    """A file, folder or link."""

    mode: int  # st_mode
    content: bytes = b""
    target: str = ""  # of a link


class Unpacked:
    """What was handed in, a file or a folder, in memory; GradingError if there is too much."""

    def __init__(self) -> None:
        self.entries: Dict[str, Entry] = {}  # by path, with slashes; the file or folder itself has an empty one
        self._used = {False: 0, True: 0}  # bytes, also of archives
        self.notes: List[str] = []  # about what is not used

    def add(self, path: str, entry: Entry) -> None:
        """Add an entry, or replace the one of that name."""
        self.entries[path] = entry
        if len(self.entries) > MAX_ENTRIES:
            raise GradingError(TOO_MANY)

    def add_file(self, path: str, mode: int, source: "IO[bytes]", size: int) -> None:
        """Add a file, if there is room for it; `size`: its bytes, as it says itself."""
        with source:
            if is_ungraded(path, size):
                self.notes.append(f"{path} ({size // MB} MB) {NOT_GRADED}")
                return
            packed = is_archive(path)
            limit = MAX_PACKED if packed else MAX_BYTES
            room = limit - self._used[packed]
            content = source.read(room + 1)
        if len(content) > room:
            sizes = [(len(entry.content), it) for it, entry in self.entries.items()]
            most, largest = max([*sizes, (max(size, len(content)), path)])
            raise GradingError(
                f"larger than {limit // MB} MB; the largest file in it is {largest} with {most / MB:.1f} MB"
            )
        self._used[packed] += len(content)
        self.add(path, Entry(mode, content))

    @property
    def digest(self) -> str:
        """A text that changes with the content."""
        sums = hashlib.sha256()
        for path, (mode, content, target) in sorted(self.entries.items()):
            sums.update(repr((path, mode, hashlib.sha256(content).digest(), target)).encode("utf-8", "replace"))
        return sums.hexdigest()

    def write(self, top: Path) -> None:
        """Write it to `top`, which does not exist yet; GradingError if that is not possible."""
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
            raise GradingError(f"can't be unpacked: {error}") from error


def is_ungraded(name: str, size: int) -> bool:
    """Return whether a file is so large, and of such a kind, that it is left out."""
    return size > MAX_UNGRADED and PurePosixPath(name).suffix.lower() in UNGRADED


def is_archive(name: str) -> bool:
    """Return whether a file of this name can be unpacked."""
    return name.lower().endswith(SUFFIXES)


def is_left_out(path: PurePosixPath) -> bool:
    """Return whether a path belongs to a generated file, or to a file that only its owner's desktop uses."""
    return bool(LEFT_OUT.intersection(path.parts)) or path.name.startswith(APPLE_DOUBLE)


def unpack_archive(file: "IO[bytes]", found: Unpacked, prefix: str = "") -> None:
    """Add the files and links of a zip or tar archive, each below `prefix`; GradingError if that is not possible."""
    try:
        (_unpack_zip if _is_zip(file) else _unpack_tar)(file, found, prefix)
    except GradingError:
        raise
    except Exception as error:  # zipfile and tarfile document no list of exceptions for malformed files
        raise GradingError(f"can't be unpacked: {error or type(error).__name__}") from error
    for path in found.entries:
        for folder in map(str, PurePosixPath(path).parents):  # what is below a link would be written elsewhere
            if folder in found.entries and not stat.S_ISDIR(found.entries[folder].mode):
                raise GradingError(f"{path}: {folder} is a file or a link, too")


def _is_zip(file: "IO[bytes]") -> bool:
    """Return whether a file is a zip; a tar that ends with a zip looks like one to zipfile."""
    file.seek(0)
    return file.read(2) == b"PK" and zipfile.is_zipfile(file)


def _unpack_zip(file: "IO[bytes]", found: Unpacked, prefix: str) -> None:
    end = zipfile._EndRecData(file)  # type: ignore[attr-defined]  # private: nothing public reads only this
    if end and end[DIRECTORY_SIZE] > MAX_DIRECTORY:
        raise GradingError(TOO_MANY)
    with zipfile.ZipFile(file) as archive:
        for info in archive.infolist():
            mode = info.external_attr >> 16
            name = _name_in_zip(info).replace("\\", "/")  # Windows' own zips have backslashes
            if name.endswith("/") or is_left_out(PurePosixPath(name)):
                continue
            path, source = _path(name, prefix), archive.open(info)
            if stat.S_ISLNK(mode):
                found.add(path, Entry(LINK, target=os.fsdecode(source.read(MAX_TARGET))))
            else:
                found.add_file(path, file_mode(mode), source, info.file_size)


def _name_in_zip(info: zipfile.ZipInfo) -> str:
    """The name of an entry: without the flag for UTF-8, macOS writes UTF-8, and a Czech Windows code page 852."""
    if info.flag_bits & UTF_8:
        return info.filename
    try:
        raw = info.filename.encode("cp437")  # as zipfile has decoded it
        return raw.decode()
    except UnicodeDecodeError:
        return raw.decode("cp852")
    except UnicodeEncodeError:  # newer zipfile: from a field that some zips have beside the name
        return info.filename


def _unpack_tar(file: "IO[bytes]", found: Unpacked, prefix: str) -> None:
    file.seek(0)
    begin = file.read(max(map(len, COMPRESSIONS)))
    file.seek(0)
    opener = next((opener for magic, opener in COMPRESSIONS.items() if begin.startswith(magic)), None)
    # In one piece, as tarfile would read more than fits into memory for some headers.
    plain = (opener(file) if opener else file).read(MAX_PACKED + 1)
    if plain.startswith(tree.POINTER):
        raise GradingError(tree.IS_POINTER)
    if len(plain) > MAX_PACKED:
        raise GradingError(f"larger than {MAX_PACKED // MB} MB")
    try:
        archive = tarfile.open(fileobj=io.BytesIO(plain), mode="r:")
    except tarfile.ReadError:
        raise GradingError("neither a zip nor a tar archive") from None
    for member in archive:
        if member.isdir() or is_left_out(PurePosixPath(member.name)):
            continue
        path = _path(member.name, prefix)
        if member.issym():
            found.add(path, Entry(LINK, target=member.linkname))
            continue
        try:
            source = archive.extractfile(member)  # of a hard link: the file's that it is another name of
        except KeyError:
            raise GradingError(f"{member.name}: a hard link to {member.linkname}, which is not in it") from None
        if source is None:
            raise GradingError(f"{member.name}: expected a file, folder or link")
        found.add_file(path, file_mode(member.mode), source, member.size)


def file_mode(mode: int) -> int:
    """A file's mode without what a umask has made of it: readable by everybody, executable or not."""
    return stat.S_IFREG | (0o755 if mode & 0o111 else 0o644)


def _path(name: str, prefix: str) -> str:
    path = PurePosixPath(name)
    if ".." in path.parts or path.is_absolute() or not path.parts or "\0" in name:
        raise GradingError(f"{name}: expected a path within the archive")
    if len(path.parts) > tree.MAX_DEPTH:
        raise GradingError(f"expected at most {tree.MAX_DEPTH} nested folders")
    return str(PurePosixPath(prefix, path))
