"""Read the <geometry> of a collision."""

import math
from typing import Callable, Dict, Optional

import numpy as np

from ...geometry import FARTHEST
from ...reading import Element, file_of
from ..model import Box, Cylinder, Geometry, Mesh, Plane, Sphere
from . import uris, xml
from .large_meshes import load_triangles


class Shapes:
    """A reader of geometries that reads each mesh file only once."""

    def __init__(self) -> None:
        self._triangles: Dict[str, np.ndarray] = {}
        self._readers: Dict[str, Callable[[Element], Optional[Geometry]]] = {
            "box": _box,
            "cylinder": _cylinder,
            "empty": lambda _: None,
            "mesh": self._mesh,
            "plane": _plane,
            "sphere": _sphere,
        }

    def read(self, geometry: Element) -> Optional[Geometry]:
        """The shape in a <geometry>; None for <empty>. WorldError for unsupported shapes, such as <heightmap>."""
        xml.require_known_children(geometry, read=self._readers)
        shapes = [child for child in geometry if child.tag in self._readers]
        if len(shapes) != 1:
            known = ", ".join(self._readers)
            raise xml.error(geometry, f"<geometry> has {len(shapes)} shapes; supported: exactly one of {known}")
        return self._readers[shapes[0].tag](shapes[0])

    def _mesh(self, mesh: Element) -> Mesh:
        xml.require_known_children(mesh, read=("scale", "uri"))
        uri = xml.required_child(mesh, "uri")
        with xml.about(uri):
            path = uris.locate(xml.text_of(uri), file_of(uri))
            if path not in self._triangles:
                self._triangles[path] = load_triangles(path)
        scale = xml.optional_child(mesh, "scale")
        factors = (1.0, 1.0, 1.0) if scale is None else xml.numbers(scale, 3)
        if 0.0 in factors:
            raise xml.error(mesh, f"<scale> is '{' '.join(f'{f:g}' for f in factors)}', expected factors other than 0")
        with np.errstate(over="ignore"):
            corners = self._triangles[path] * factors
        if np.abs(corners).max() > FARTHEST:
            raise xml.error(mesh, f"{path} has corners beyond +-{FARTHEST:g} m")
        return Mesh(corners, path)


def _box(box: Element) -> Box:
    x, y, z = xml.numbers(xml.required_child(box, "size"), 3, positive=True)
    return Box((x, y, z))


def _cylinder(cylinder: Element) -> Cylinder:
    return Cylinder(_length(cylinder, "radius"), _length(cylinder, "length"))


def _plane(plane: Element) -> Plane:
    # <size> only applies to a visual: a plane's collision is infinite.
    normal = xml.optional_child(plane, "normal")
    x, y, z = (0.0, 0.0, 1.0) if normal is None else xml.numbers(normal, 3)
    length = math.hypot(x, y, z)
    if not 0.0 < length < math.inf:
        raise xml.error(plane, f"<normal> is '{x} {y} {z}', expected a vector that is not zero")
    return Plane((x / length, y / length, z / length))


def _sphere(sphere: Element) -> Sphere:
    return Sphere(_length(sphere, "radius"))


def _length(shape: Element, tag: str) -> float:
    """The length [m], greater than 0, that a shape's child with this tag gives."""
    return xml.numbers(xml.required_child(shape, tag), 1, positive=True)[0]
