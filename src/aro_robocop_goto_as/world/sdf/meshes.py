"""Read the triangles of a mesh file."""

import io
import os
from typing import Any, Callable, Dict

import numpy as np

from ...errors import WorldError
from ...reading import finite_numbers, parse_xml, reading
from .wavefront_obj import read_obj


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


def _read_stl(content: bytes, _path: str) -> np.ndarray:
    import trimesh  # imported late: it takes half a second and 20 MB, and few worlds have meshes

    loaded: Any = trimesh.load_mesh(io.BytesIO(content), file_type="stl", process=False)
    return np.asarray(loaded.triangles, dtype=float)


def _read_collada(content: bytes, path: str) -> np.ndarray:
    """Read by pycollada itself: trimesh's reader, which is based on it, takes 2.5 times as long (measured)."""
    unit = _collada_unit(content, path)
    from collada import Collada, common, polylist, triangleset

    triangles = [np.zeros((0, 3, 3))]
    scene = Collada(io.BytesIO(content), ignore=[common.DaeError]).scene  # such as a texture that is missing
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
    element = parse_xml(content, path, WorldError).find("{*}asset/{*}unit")
    text = "1" if element is None else element.get("meter", "1")
    try:
        return finite_numbers(text, 1, positive=True)[0]
    except ValueError as exc:
        raise WorldError(f"{path}:{element.sourceline}: <unit meter='{text}'>, {exc}") from exc


_READERS: Dict[str, Callable[[bytes, str], np.ndarray]] = {
    ".dae": _read_collada,
    ".obj": read_obj,
    ".stl": _read_stl,
}
