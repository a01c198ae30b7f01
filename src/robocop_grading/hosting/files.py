"""Reading files written by others, which may be pipes, devices, or too large."""

import os
import stat
from pathlib import Path
from typing import Optional
from xml.etree import ElementTree

from aro_robocop_goto_as.errors import HostingError

MAX_SIZE = 1024**2  # bytes of a manifest, launch file or script


def read_bytes(path: Path, top: Optional[Path] = None) -> bytes:
    """The content of a regular file; HostingError for a pipe, a device, or more than a megabyte.

    With `top`, it also has to be inside of that folder, wherever links in its path lead.
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
    return content


def read_text(path: Path, top: Optional[Path] = None) -> str:
    """The file as text; invalid UTF-8 is replaced."""
    return read_bytes(path, top).decode(errors="replace")


def read_xml(path: Path, top: Optional[Path] = None) -> ElementTree.Element:
    """The file's XML root; HostingError says where it is malformed."""
    try:
        return ElementTree.fromstring(read_bytes(path, top))
    except (ElementTree.ParseError, ValueError, LookupError) as error:  # the last two: encodings
        raise HostingError(f"{path}: not XML that can be read: {error}") from error
