"""Read the <geometry> of a collision."""

import math
from typing import Dict, Optional

import numpy as np

from ...geometry import MAX_COORDINATE
from ...reading import Element, file_of
from ...shapes import Box, Cylinder, Geometry, Mesh, Plane, Sphere
from . import uris, xml
from .meshes import load_triangles

_SHAPES = ("box", "cylinder", "empty", "mesh", "plane", "sphere")


def read_shape(geometry: Element, triangles: Dict[str, np.ndarray]) -> Optional[Geometry]:
    """The shape in a <geometry>; None for <empty>. NotSimulatedError for other shapes, and for a part of a mesh.

    triangles: of the mesh files that the world has used so far, by path; this function reads and adds others
    """
    for other in [*xml.unknown_children(geometry, _SHAPES), *geometry.iterfind("mesh/submesh")]:
        raise xml.NotSimulatedError(f"<{other.tag}>")
    shapes = [child for child in geometry if child.tag in _SHAPES]
    if len(shapes) != 1:
        known = ", ".join(_SHAPES)
        raise xml.error(geometry, f"<geometry> has {len(shapes)} shapes; supported: exactly one of {known}")
    (shape,) = shapes
    if shape.tag == "box":
        x, y, z = xml.numbers(xml.required_child(shape, "size"), 3, positive=True)
        return Box((x, y, z))
    if shape.tag == "cylinder":
        return Cylinder(_length(shape, "radius"), _length(shape, "length"))
    if shape.tag == "sphere":
        return Sphere(_length(shape, "radius"))
    if shape.tag == "plane":
        return _plane(shape)
    return _mesh(shape, triangles) if shape.tag == "mesh" else None


def _mesh(mesh: Element, triangles: Dict[str, np.ndarray]) -> Mesh:
    uri = xml.required_child(mesh, "uri")
    with xml.about(uri):
        path = uris.locate(xml.text_of(uri), file_of(uri))
        if path not in triangles:
            triangles[path] = load_triangles(path)
    scale = xml.optional_child(mesh, "scale")
    factors = (1.0, 1.0, 1.0) if scale is None else xml.numbers(scale, 3)
    if 0.0 in factors:
        raise xml.error(mesh, f"<scale> is '{' '.join(f'{f:g}' for f in factors)}', expected factors other than 0")
    with np.errstate(over="ignore"):
        corners = triangles[path] * factors
    if np.abs(corners).max() > MAX_COORDINATE:
        raise xml.error(mesh, f"{path} has corners beyond +-{MAX_COORDINATE:g} m")
    return Mesh(corners, path)


def _plane(plane: Element) -> Plane:
    # <size> only applies to a visual: a plane's collision is infinite.
    normal = xml.optional_child(plane, "normal")
    x, y, z = (0.0, 0.0, 1.0) if normal is None else xml.numbers(normal, 3)
    length = math.hypot(x, y, z)
    if not 0.0 < length < math.inf:
        raise xml.error(plane, f"<normal> is '{x} {y} {z}', expected a vector that is not zero")
    return Plane((x / length, y / length, z / length))


def _length(shape: Element, tag: str) -> float:
    """The length [m], greater than 0, that a shape's child with this tag gives."""
    return xml.numbers(xml.required_child(shape, tag), 1, positive=True)[0]
