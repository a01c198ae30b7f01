"""Read the triangles of a Wavefront .obj file: vertices and faces; everything else in it is skipped.

trimesh 4.6 has a reader too, but it silently reads a different shape from valid files: negative indices count from the
end of the file rather than from the face, and lines that are indented or separated by tabs are dropped. It accepts
index 0 as the last vertex, refuses comments after a face and bytes that are not UTF-8, and its errors name no line.
"""

import math
from typing import List, Tuple

import numpy as np

from ...errors import WorldError

Face = Tuple[int, ...]  # vertex indices, from 0


def read_obj(content: bytes, path: str) -> np.ndarray:
    """The triangles (n, 3, 3), in the file's own unit; faces with more than three vertices are split into fans.

    path: the file's name for messages. WorldError names it, the line, the text found there and what was expected.
    """
    vertices: List[Tuple[float, ...]] = []
    faces: List[Tuple[int, Face]] = []  # with the line number: a face may use vertices that are defined later
    for number, line in _lines(content):
        words = line.split()
        if words[:1] == [b"v"]:
            vertices.append(_vertex(words[1:4], f"{path}:{number}"))
        elif words[:1] == [b"f"]:
            faces.append((number, _face(words[1:], len(vertices), f"{path}:{number}")))
    for number, face in faces:
        if max(face) >= len(vertices):
            raise WorldError(
                f"{path}:{number}: f has vertex {max(face) + 1}, expected one of the file's {len(vertices)}"
            )
    fans = [(face[0], b, c) for _, face in faces for b, c in zip(face[1:], face[2:])]
    return np.array(vertices, dtype=float).reshape(-1, 3)[np.array(fans, dtype=int).reshape(-1, 3)]


def _lines(content: bytes) -> List[Tuple[int, bytes]]:
    """The file's lines with their numbers, without comments; a backslash at the end continues a line."""
    lines: List[Tuple[int, bytes]] = []
    continued = False
    for number, line in enumerate(content.splitlines(), 1):
        line = line.partition(b"#")[0].rstrip()
        if continued:
            number, line = lines[-1][0], lines.pop()[1] + line
        continued = line.endswith(b"\\")
        lines.append((number, line[:-1] + b" " if continued else line))
    return lines


def _vertex(words: List[bytes], place: str) -> Tuple[float, ...]:
    try:
        values = tuple(float(word) for word in words)
    except ValueError:
        values = ()
    if len(values) != 3 or not all(math.isfinite(value) for value in values):
        raise WorldError(f"{place}: v is '{_quoted(words)}', expected 3 finite numbers")
    return values


def _face(words: List[bytes], defined: int, place: str) -> Face:
    """A face's vertices: 1 is the file's first one, -1 the last one defined before the face; `/...` is skipped."""
    try:
        indices = [int(word.partition(b"/")[0]) for word in words]
    except ValueError:
        indices = []
    if len(indices) < 3 or not all(index > 0 or -defined <= index < 0 for index in indices):
        raise WorldError(
            f"{place}: f is '{_quoted(words)}', expected 3 or more vertices, whole numbers from 1 on or, "
            f"below 0, of the {defined} before it"
        )
    return tuple(index - 1 if index > 0 else defined + index for index in indices)


def _quoted(words: List[bytes]) -> str:
    """Words of a file, which may not be text, for a message."""
    text = b" ".join(words).decode("utf-8", "backslashreplace")
    return text if len(text) <= 60 and text.isprintable() else ascii(text[:60])[1:-1] + "..."
