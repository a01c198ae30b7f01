"""<geometry> of a collision -> Geometry."""

import math
from typing import Callable, Dict, Optional

import numpy as np

from . import meshes, resources, sdf
from .errors import WorldError
from .shapes import Box, Cylinder, Geometry, Mesh, Plane, Sphere


class Shapes:
    """Reads geometries; a mesh file that is used often is read once."""

    def __init__(self) -> None:
        self._triangles: Dict[str, np.ndarray] = {}
        self._readers: Dict[str, Callable[[sdf.Element], Optional[Geometry]]] = {
            "box": _box, "cylinder": _cylinder, "empty": lambda _: None, "mesh": self._mesh, "plane": _plane,
            "sphere": _sphere}

    def read(self, geometry: sdf.Element) -> Optional[Geometry]:
        """The one shape of a <geometry>; None of an <empty>. WorldError for others, such as <heightmap>."""
        sdf.check_children(geometry, read=self._readers)
        shapes = [child for child in geometry if child.tag in self._readers]
        if len(shapes) != 1:
            known = ", ".join(self._readers)
            raise sdf.error(geometry, f"<geometry> holds {len(shapes)} shapes; supported: one of {known}")
        return self._readers[shapes[0].tag](shapes[0])

    def _mesh(self, mesh: sdf.Element) -> Mesh:
        sdf.check_children(mesh, read=("scale", "uri"))
        uri = sdf.need(mesh, "uri")
        path = resources.find_file(sdf.text_of(uri), uri)
        if path not in self._triangles:
            try:
                self._triangles[path] = meshes.load_triangles(path)
            except WorldError as exc:
                raise sdf.error(uri, str(exc)) from exc
        scale = sdf.only(mesh, "scale")
        factors = (1.0, 1.0, 1.0) if scale is None else sdf.numbers(scale, 3)
        if 0.0 in factors:
            raise sdf.error(mesh, f"<scale> is '{' '.join(f'{f:g}' for f in factors)}', expected no zero in it")
        return Mesh(self._triangles[path] * factors, path)


def _box(box: sdf.Element) -> Box:
    x, y, z = sdf.sizes(sdf.need(box, "size"), 3)
    return Box((x, y, z))


def _cylinder(cylinder: sdf.Element) -> Cylinder:
    (radius,), (length,) = (sdf.sizes(sdf.need(cylinder, tag), 1) for tag in ("radius", "length"))
    return Cylinder(radius, length)


def _plane(plane: sdf.Element) -> Plane:
    # SDF's <size> is that of the visual: its plane collides everywhere.
    normal = sdf.only(plane, "normal")
    x, y, z = (0.0, 0.0, 1.0) if normal is None else sdf.numbers(normal, 3)
    length = math.hypot(x, y, z)
    if not 0.0 < length < math.inf:
        raise sdf.error(plane, f"<normal> is '{x} {y} {z}', expected a direction")
    return Plane((x / length, y / length, z / length))


def _sphere(sphere: sdf.Element) -> Sphere:
    (radius,) = sdf.sizes(sdf.need(sphere, "radius"), 1)
    return Sphere(radius)
