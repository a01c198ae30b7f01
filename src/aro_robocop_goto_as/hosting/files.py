"""Reading files written by others, which may be pipes, devices, or too large."""

import os
import stat
from pathlib import Path
from xml.etree import ElementTree

from ..errors import HostingError

MAX_SIZE = 1024**2  # bytes of a manifest, launch file or script


def read_bytes(path: Path) -> bytes:
    """The content of a regular file; HostingError for a pipe, a device, or more than a megabyte."""
    try:
        if not stat.S_ISREG(os.stat(path).st_mode):  # opening a device can have effects by itself
            raise HostingError(f"{path}: expected an ordinary file")
        with open(os.open(path, os.O_RDONLY | os.O_NONBLOCK), "rb") as file:
            content = file.read(MAX_SIZE + 1)
    except OSError as error:
        raise HostingError(f"{path}: can't be read, expected an ordinary file: {error.strerror}") from error
    if len(content) > MAX_SIZE:
        raise HostingError(f"{path}: expected less than {MAX_SIZE // 1024} kB")
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
