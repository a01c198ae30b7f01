"""Read the triangles of a mesh file."""

import io
import math
import os
from typing import Any

import numpy as np

from ...errors import WorldError
from . import xml
from .wavefront_obj import read_obj

FORMATS = (".dae", ".obj", ".stl")


def load_triangles(path: str) -> np.ndarray:
    """The triangles (n, 3, 3) [m] of a mesh file, with its parts placed as in the file's scene.

    Lengths are in metres unless a COLLADA file declares another unit; <up_axis> is ignored, as in Gazebo Classic.
    WorldError if the file can't be read, has another format, or contains no triangles.
    """
    kind = os.path.splitext(path)[1].lower()
    if kind not in FORMATS:
        raise WorldError(f"{path}: not a supported mesh format; supported: {', '.join(FORMATS)}")
    try:
        with open(path, "rb") as file:
            content = file.read()
    except OSError as exc:
        raise WorldError(f"{path}: can't read the mesh: {exc.strerror or exc}") from exc
    unit = _collada_unit(content, path) if kind == ".dae" else 1.0
    triangles = read_obj(content, path) if kind == ".obj" else _parsed(content, kind, path) * unit
    if not len(triangles):
        raise WorldError(f"{path}: the mesh has no triangles")
    if not np.isfinite(triangles).all():
        raise WorldError(f"{path}: the mesh has corners that are not finite numbers")
    return triangles


def _parsed(content: bytes, kind: str, path: str) -> np.ndarray:
    import trimesh  # imported late: it takes half a second and 20 MB, and few worlds have meshes

    # trimesh and pycollada do not document what they raise; a broken file can lead to almost any exception.
    try:
        loaded: Any = trimesh.load_scene(io.BytesIO(content), file_type=kind[1:], process=False, skip_materials=True)
        return np.asarray(loaded.to_mesh().triangles, dtype=float)
    except Exception as exc:
        raise WorldError(f"{path}: not a mesh in {kind} format: {exc or type(exc).__name__}") from exc


def _collada_unit(content: bytes, path: str) -> float:
    """Metres per unit of a COLLADA file; WorldError if it is not XML or has a DOCTYPE."""
    element = xml.parse_text(content, path).find("{*}asset/{*}unit")
    text = "1" if element is None else element.get("meter", "1")
    try:
        unit = float(text)
    except ValueError:
        unit = math.nan
    if not 0.0 < unit < math.inf:
        raise WorldError(f"{path}:{element.sourceline}: <unit meter='{text}'>, expected a number greater than 0")
    return unit
