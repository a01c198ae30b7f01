"""Wavefront .obj -> triangles. Only corners and faces count: textures, normals, materials, lines, points are skipped.

By the format's own description, which trimesh's reader leaves at two points: its index 0 is the last corner of the
file, and its negative ones count from there rather than from the face.
"""

import math
from typing import List, Tuple

import numpy as np

from .errors import WorldError

Corners = Tuple[int, ...]  # of a face, from 0


def read_obj(content: bytes, path: str) -> np.ndarray:
    """The triangles (n, 3, 3), in the file's own unit, of its faces; those of more corners are split into fans.

    path: what messages call the file. WorldError names it, the line, what is there and what is expected.
    """
    corners: List[Tuple[float, ...]] = []
    faces: List[Tuple[int, Corners]] = []  # with the number of the line: a face may use corners that come later
    for number, line in _lines(content):
        words = line.split()
        if words[:1] == [b"v"]:
            corners.append(_numbers(words[1:4], f"{path}:{number}"))
        elif words[:1] == [b"f"]:
            faces.append((number, _face(words[1:], len(corners), f"{path}:{number}")))
    for number, face in faces:
        if max(face) >= len(corners):
            raise WorldError(f"{path}:{number}: f has corner {max(face) + 1}, expected one of the file's "
                             f"{len(corners)}")
    fans = [(face[0], b, c) for _, face in faces for b, c in zip(face[1:], face[2:])]
    return np.array(corners, dtype=float).reshape(-1, 3)[np.array(fans, dtype=int).reshape(-1, 3)]


def _lines(content: bytes) -> List[Tuple[int, bytes]]:
    """The file's lines with their numbers; one that ends with a backslash goes on in the next."""
    found: List[Tuple[int, bytes]] = []
    open_end = False
    for number, line in enumerate(content.splitlines(), 1):
        line = line.partition(b"#")[0].rstrip()
        if open_end:
            number, line = found[-1][0], found.pop()[1] + line
        open_end = line.endswith(b"\\")
        found.append((number, line[:-1] + b" " if open_end else line))
    return found


def _numbers(words: List[bytes], place: str) -> Tuple[float, ...]:
    try:
        values = tuple(float(word) for word in words)
    except ValueError:
        values = ()
    if len(values) != 3 or not all(math.isfinite(value) for value in values):
        raise WorldError(f"{place}: v is '{_told(words)}', expected 3 finite numbers")
    return values


def _face(words: List[bytes], so_far: int, place: str) -> Corners:
    """A face's corners: 1 is the file's first one, -1 the last one before the face; what follows a slash is skipped."""
    try:
        indices = [int(word.partition(b"/")[0]) for word in words]
    except ValueError:
        indices = []
    if len(indices) < 3 or not all(index > 0 or -so_far <= index < 0 for index in indices):
        raise WorldError(f"{place}: f is '{_told(words)}', expected 3 or more corners, whole numbers from 1 on or, "
                         f"below 0, of the {so_far} before it")
    return tuple(index - 1 if index > 0 else so_far + index for index in indices)


def _told(words: List[bytes]) -> str:
    """Words of a file for a message, which may be no text at all."""
    text = b" ".join(words).decode("utf-8", "backslashreplace")
    return text if len(text) <= 60 and text.isprintable() else ascii(text[:60])[1:-1] + "..."
