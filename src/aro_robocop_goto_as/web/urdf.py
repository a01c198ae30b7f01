"""A robot's description -> the shapes of its links."""

from typing import Callable, Dict, List, Optional, Tuple

import numpy as np
from lxml import etree

from ..errors import RobotModelError, WorldError
from ..geometry import Pose3D, Vector3
from ..world.sdf.meshes import load_triangles
from .shapes import BOX, CYLINDER, MESH, SPHERE, Color, Placed, Shape

PLAIN: Color = (150, 150, 155)  # of a visual without a colour
MeshFinder = Callable[[str], Optional[str]]  # a mesh's URI -> its file, None if it can't be found


def read_links(text: str, find_mesh: MeshFinder = lambda uri: None) -> Dict[str, List[Placed]]:
    """The visuals of every link, by the link's name; links without visuals have none.

    Meshes that can't be found or read are left out. RobotModelError if the description is not a URDF.
    """
    try:
        root = etree.fromstring(
            text.encode(), etree.XMLParser(resolve_entities=False, no_network=True, remove_comments=True)
        )
    except (etree.XMLSyntaxError, UnicodeError) as error:
        raise RobotModelError(f"robot_description is not XML: {error}") from error
    if root.tag != "robot":
        raise RobotModelError(f"robot_description: expected <robot>, got <{root.tag}>")
    try:
        colors = {material.get("name", ""): _color(material) for material in root.findall("material")}
        return {link.get("name", ""): _visuals(link, colors, find_mesh) for link in root.findall("link")}
    except ValueError as error:
        raise RobotModelError(f"robot_description: {error}") from error


Colors = Dict[str, Optional[Tuple[Color, float]]]


def _visuals(link: "etree._Element", colors: Colors, find_mesh: MeshFinder) -> List[Placed]:
    found = []
    for visual in link.findall("visual"):
        material = visual.find("material")
        look = None if material is None else _color(material) or colors.get(material.get("name", ""))
        shape = _shape(visual.find("geometry"), look or (PLAIN, 1.0), find_mesh)
        if shape is not None:
            found.append((shape, _origin(visual.find("origin"))))
    return found


def _shape(geometry: "Optional[etree._Element]", look: Tuple[Color, float], find_mesh: MeshFinder) -> Optional[Shape]:
    if geometry is None or not len(geometry):
        return None
    element, (color, opacity) = geometry[0], look
    if element.tag == "box":
        return Shape(BOX, _vector(element.get("size", "")), color, opacity)
    if element.tag == "cylinder":
        diameter = 2.0 * float(element.get("radius", ""))
        return Shape(CYLINDER, (diameter, diameter, float(element.get("length", ""))), color, opacity)
    if element.tag == "sphere":
        diameter = 2.0 * float(element.get("radius", ""))
        return Shape(SPHERE, (diameter, diameter, diameter), color, opacity)
    if element.tag == "mesh":
        path = find_mesh(element.get("filename", ""))
        if path is None:
            return None
        try:
            triangles = load_triangles(path) * np.array(_vector(element.get("scale", "1 1 1")))
        except WorldError:
            return None
        corners = tuple((x, y, z) for x, y, z in triangles.reshape(-1, 3).tolist())
        return Shape(MESH, color=color, opacity=opacity, points=corners)
    return None


def _color(material: "etree._Element") -> Optional[Tuple[Color, float]]:
    color = material.find("color")
    if color is None:
        return None
    red, green, blue, opacity = (min(max(float(word), 0.0), 1.0) for word in color.get("rgba", "").split())
    return (round(255 * red), round(255 * green), round(255 * blue)), opacity


def _origin(origin: "Optional[etree._Element]") -> Pose3D:
    if origin is None:
        return Pose3D()
    return Pose3D.from_xyz_rpy(_vector(origin.get("xyz", "0 0 0")), _vector(origin.get("rpy", "0 0 0")))


def _vector(text: str) -> Vector3:
    x, y, z = (float(word) for word in text.split())
    return (x, y, z)
