"""Read the triangles of a Wavefront .obj file: vertices and faces; everything else in it is skipped.

trimesh 4.6 has a reader too, but it silently reads a different shape from valid files: negative indices count from the
end of the file rather than from the face, and lines that are indented or separated by tabs are dropped. It accepts
index 0 as the last vertex, refuses comments after a face and bytes that are not UTF-8, and its errors name no line.
"""

import codecs
import re
from typing import List, Tuple

import numpy as np

from ...errors import WorldError
from ...reading import finite_numbers


def read_obj(content: bytes, path: str) -> np.ndarray:
    """The triangles (n, 3, 3), in the file's own unit; faces with more than three vertices are split into fans.

    path: the file's name for messages. WorldError names it, the line, the text found there and what was expected.
    """
    vertices: List[Tuple[float, ...]] = []
    fans: List[Tuple[int, int, int]] = []  # indices of vertices, from 0
    last, last_line = -1, 0  # the largest index so far, and its line: a face may use vertices that are defined later
    for number, line in _lines(content):
        kind, *words = line.split() or [b""]
        try:
            if kind == b"v":
                vertices.append(finite_numbers(b" ".join(words[:3]).decode("ascii", "replace"), 3))
            elif kind == b"f":
                face = _face(words, len(vertices))
                fans += [(face[0], second, third) for second, third in zip(face[1:], face[2:])]
                last, last_line = max((last, last_line), (max(face), number))
        except ValueError as exc:
            raise WorldError(f"{path}:{number}: {kind.decode()} is '{_quoted(words)}', {exc}") from exc
    if last >= len(vertices):
        raise WorldError(f"{path}:{last_line}: f has vertex {last + 1}, expected one of the file's {len(vertices)}")
    return np.array(vertices, dtype=float).reshape(-1, 3)[np.array(fans, dtype=int).reshape(-1, 3)]


def _lines(content: bytes) -> List[Tuple[int, bytes]]:
    """The file's lines with their numbers, without comments; a backslash at the end continues a line."""
    lines: List[Tuple[int, bytes]] = []
    continued = False
    if content.startswith(codecs.BOM_UTF8):
        content = content[len(codecs.BOM_UTF8) :]
    for number, line in enumerate(content.splitlines(), 1):
        line = line.partition(b"#")[0].rstrip()
        if continued:
            number, line = lines[-1][0], lines.pop()[1] + line
        continued = line.endswith(b"\\")
        lines.append((number, line[:-1] + b" " if continued else line))
    return lines


def _face(words: List[bytes], defined: int) -> List[int]:
    """A face's vertices: 1 is the file's first one, -1 the last one defined before the face; `/...` is skipped."""
    if len(words) >= 3 and all(re.fullmatch(rb"-?\d{1,18}(/.*)?", word) for word in words):
        indices = [int(word.partition(b"/")[0]) for word in words]
        if all(index > 0 or -defined <= index < 0 for index in indices):
            return [index - 1 if index > 0 else defined + index for index in indices]
    raise ValueError(f"expected 3 or more vertices, whole numbers from 1 on or, below 0, of the {defined} before it")


def _quoted(words: List[bytes]) -> str:
    """Words of a file, which may not be text, for a message."""
    text = b" ".join(words).decode("utf-8", "backslashreplace")
    return text if len(text) <= 60 and text.isprintable() else ascii(text[:60])[1:-1] + "..."
