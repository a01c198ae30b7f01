"""A robot's description -> the shapes of its links."""

from typing import Dict, Optional, Tuple

import numpy as np

from ..errors import RobotModelError, WorldError
from ..reading import Element, parse_xml, reading
from ..robot.urdf import origin_of, primitive, vector
from ..shapes import Box, Cylinder, Sphere
from ..world.sdf.meshes import load_triangles
from ..world.sdf.uris import locate
from .scene import BODY, BOX, CYLINDER, MESH, SPHERE, Color, PlacedVisual, Visual, color_of

Look = Tuple[Color, float]  # colour, opacity
PLAIN: Look = ((150, 150, 155), 1.0)  # of a visual without a colour
NAME = "robot_description"  # in messages
MESHES = ("package://", "file://")  # where a description may take meshes from


def read_links(text: str) -> Dict[str, Visual]:
    """The links by name, each a body of its visuals; a link without visuals is left out.

    Meshes that can't be found or read are left out, too. RobotModelError if the description is not a URDF.
    """
    with reading(NAME, RobotModelError, "a URDF"):
        root = parse_xml(text.encode(), NAME, RobotModelError)
        if root.tag != "robot":
            raise RobotModelError(f"{NAME}: expected <robot>, got <{root.tag}>")
        looks = {material.get("name"): _look(material, {}) for material in root.iterfind("material")}
        placed = {
            link.get("name", ""): [_placed(visual, looks) for visual in link.iterfind("visual")]
            for link in root.iterfind("link")
        }
    links = {name: tuple(part for part in parts if part is not None) for name, parts in placed.items()}
    return {name: Visual(BODY, parts=parts) for name, parts in links.items() if parts}


def _placed(visual: Element, looks: Dict[Optional[str], Look]) -> Optional[PlacedVisual]:
    geometry = visual.find("geometry/*")
    shape = None if geometry is None else _shape(geometry, _look(visual.find("material"), looks))
    return None if shape is None else (shape, origin_of(visual))


def _shape(geometry: Element, look: Look) -> Optional[Visual]:
    solid = primitive(geometry)
    if isinstance(solid, Box):
        return Visual(BOX, solid.size, *look)
    if isinstance(solid, (Cylinder, Sphere)):
        diameter = 2.0 * solid.radius
        length = solid.length if isinstance(solid, Cylinder) else diameter
        return Visual(CYLINDER if isinstance(solid, Cylinder) else SPHERE, (diameter, diameter, length), *look)
    uri = geometry.get("filename", "")
    if geometry.tag != "mesh" or not uri.startswith(MESHES):
        return None
    try:
        triangles = load_triangles(locate(uri, "")) * np.array(vector(geometry.get("scale", "1 1 1")))
    except (WorldError, OSError):
        return None
    corners = tuple((x, y, z) for x, y, z in triangles.reshape(-1, 3).tolist())
    return Visual(MESH, color=look[0], opacity=look[1], points=corners)


def _look(material: Optional[Element], looks: Dict[Optional[str], Look]) -> Look:
    """A material's own look, else the look of the robot's material of that name."""
    color = None if material is None else material.find("color")
    if color is None:
        return looks.get(None if material is None else material.get("name"), PLAIN)
    return color_of(map(float, color.get("rgba", "").split()))
