"""Reading files that somebody else wrote: ordinary ones of a sensible size, and nothing that a read waits for."""

import os
import stat
from pathlib import Path
from xml.etree import ElementTree

from ..errors import HostingError

MOST = 1024 ** 2  # bytes of a manifest, launch file or script


def read_bytes(path: Path) -> bytes:
    """An ordinary file's content; HostingError names what is a pipe or a device, or larger than a megabyte."""
    try:
        if not stat.S_ISREG(os.stat(path).st_mode):  # opening a device can do something by itself
            raise HostingError(f"{path}: expected an ordinary file")
        with open(os.open(path, os.O_RDONLY | os.O_NONBLOCK), "rb") as file:
            content = file.read(MOST + 1)
    except OSError as error:
        raise HostingError(f"{path}: can't be read, expected an ordinary file: {error.strerror}") from error
    if len(content) > MOST:
        raise HostingError(f"{path}: expected less than {MOST // 1024} kB")
    return content


def read_text(path: Path) -> str:
    """The same as text; bytes that are none are replaced."""
    return read_bytes(path).decode(errors="replace")


def read_xml(path: Path) -> ElementTree.Element:
    """The same as XML: its root. HostingError says where it is malformed."""
    try:
        return ElementTree.fromstring(read_bytes(path))
    except (ElementTree.ParseError, ValueError, LookupError) as error:  # the latter for an unknown encoding
        raise HostingError(f"{path}: not XML that can be read: {error}") from error
