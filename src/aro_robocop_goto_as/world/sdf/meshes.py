"""Read the triangles of a mesh file."""

import codecs
import io
import os
import re
from typing import Callable, Dict, List, Tuple

import numpy as np

from ...errors import WorldError
from ...reading import finite_numbers, parse_xml, reading

# A facet of a binary .stl file.
_FACET: "np.dtype[np.void]" = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attributes", "<u2")])


def read_triangles(path: str) -> np.ndarray:
    """The triangles (n, 3, 3) [m] of a mesh file, with its parts placed as in the file's scene.

    Lengths are in metres unless a COLLADA file declares another unit; <up_axis> is ignored, as in Gazebo Classic.
    WorldError if the file can't be read, has another format, or contains no triangles.
    """
    kind = os.path.splitext(path)[1].lower()
    if kind not in _READERS:
        raise WorldError(f"{path}: not a supported mesh format; supported: {', '.join(_READERS)}")
    with reading(path, WorldError, f"a mesh in {kind} format"):
        with open(path, "rb") as file:
            content = file.read()
        triangles = _READERS[kind](content, path)
    if not len(triangles):
        raise WorldError(f"{path}: the mesh has no triangles")
    if not np.isfinite(triangles).all():
        raise WorldError(f"{path}: the mesh has corners that are not finite numbers")
    return triangles


def _read_stl(content: bytes, path: str) -> np.ndarray:
    """The facets of a binary or plain .stl file.

    It is binary if it is long enough for the number of facets in its header: as such a number, characters are too
    large. What follows the facets is skipped, as in Gazebo. Many a binary file, too, begins with "solid".
    """
    count = int.from_bytes(content[80:84], "little")
    if len(content) >= 84 + _FACET.itemsize * count:
        return np.frombuffer(content, _FACET, count, 84)["corners"].astype(float)
    if not content.lstrip().lower().startswith(b"solid"):
        raise WorldError(
            f"{path}: expected a text that starts with 'solid', or a binary file, for which {len(content)} bytes are "
            f"too few: {84 + _FACET.itemsize * count} for the {count} triangles of its header"
        )
    corners: List[Tuple[float, ...]] = []
    for number, line in _lines(content):
        kind, *words = line.lower().split() or [b""]
        try:
            if kind == b"vertex":
                corners.append(finite_numbers(b" ".join(words).decode("ascii", "replace"), 3))
        except ValueError as exc:
            raise WorldError(f"{path}:{number}: vertex is '{_quoted(words)}', {exc}") from exc
        if kind == b"endloop" and len(corners) % 3:
            raise WorldError(f"{path}:{number}: a facet does not have 3 vertices")
    return np.array(corners, dtype=float).reshape(-1, 3, 3)


def _read_collada(content: bytes, path: str) -> np.ndarray:
    unit = _collada_unit(content, path)
    from collada import Collada, common, polylist, triangleset

    triangles = [np.zeros((0, 3, 3))]
    scene = Collada(io.BytesIO(content), ignore=[common.DaeError]).scene  # such as a texture that is missing
    if scene is None:
        raise WorldError(f"{path}: no <scene>, which says where the parts of the mesh are")
    for geometry in scene.objects("geometry"):
        turn, shift = geometry.matrix[:3, :3].astype(float), geometry.matrix[:3, 3].astype(float)
        for part in geometry.original.primitives:
            faces = part.triangleset() if isinstance(part, polylist.Polylist) else part
            if isinstance(faces, triangleset.TriangleSet) and faces.vertex is not None:
                if (faces.vertex_index < 0).any():  # numpy would count from the end
                    raise WorldError(f"{path}: a triangle has a vertex below 0, expected 0 or more")
                triangles.append(faces.vertex[faces.vertex_index] @ turn.T + shift)
    return np.concatenate(triangles) * unit


def _collada_unit(content: bytes, path: str) -> float:
    """Metres per unit of a COLLADA file; WorldError if it is not XML or has a DOCTYPE."""
    root = parse_xml(content, path, WorldError)
    if not root.tag.endswith("}COLLADA"):
        raise WorldError(f"{path}:{root.sourceline}: the outermost element is <{root.tag}>, expected COLLADA's")
    element = root.find("{*}asset/{*}unit")
    text = "1" if element is None else element.get("meter", "1")
    try:
        return finite_numbers(text, 1, positive=True)[0]
    except ValueError as exc:
        raise WorldError(f"{path}:{element.sourceline}: <unit meter='{text}'>, {exc}") from exc


def _read_obj(content: bytes, path: str) -> np.ndarray:
    """The faces of a Wavefront .obj file, those with more than three vertices as fans; everything else is skipped."""
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


_READERS: Dict[str, Callable[[bytes, str], np.ndarray]] = {
    ".dae": _read_collada,
    ".obj": _read_obj,
    ".stl": _read_stl,
}
