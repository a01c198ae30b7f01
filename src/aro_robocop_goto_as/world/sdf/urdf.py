"""Rewrite the URDF of an object as SDF, as Gazebo does before it spawns one."""

from lxml import etree

from ...reading import Element
from .xml import error


def as_sdf(robot: Element) -> Element:
    """An <sdf> with the model that a URDF's <robot> describes: its links' collisions, with all joints at zero.

    Elements keep the file and line of what they were made from; what is wrong in them is found when they are read.
    WorldError if there is no link.
    """
    if robot.find("link") is None:
        raise error(robot, "<robot> has no <link>")
    sdf = etree.Element("sdf", version="1.7")
    sdf.getroottree().docinfo.URL = robot.getroottree().docinfo.URL
    model = _child(sdf, "model", robot, name=robot.get("name", ""))
    joints = {child.get("link", ""): child.getparent() for child in robot.iterfind("joint/child")}
    roots = {link.get("name", "") for link in robot.iterchildren("link")} - set(joints)  # each is where the model is
    for link in robot.iterchildren("link"):
        made = _child(model, "link", link, name=link.get("name", ""))
        joint = joints.get(link.get("name", ""))
        if joint is not None:
            parent = joint.find("parent")
            name = "" if parent is None else parent.get("link", "")
            _pose(made, joint, relative_to="" if name in roots else name)  # a root is often called world
        for number, collision in enumerate(link.iterchildren("collision")):
            part = _child(made, "collision", collision, name=collision.get("name") or f"collision_{number}")
            _pose(part, collision)
            for geometry in collision.iterchildren("geometry"):
                _shape(_child(part, "geometry", geometry), geometry)
    return sdf


def _child(parent: Element, tag: str, origin: Element, **attributes: str) -> Element:
    """A new element at the line of what it is made from."""
    made = etree.SubElement(parent, tag, attributes)
    made.sourceline = origin.sourceline
    return made


def _pose(parent: Element, of: Element, **attributes: str) -> None:
    """The <pose> for the <origin> of a joint or a collision."""
    origin = of.find("origin")
    xyz, rpy = ("0 0 0",) * 2 if origin is None else (origin.get(key, "0 0 0") for key in ("xyz", "rpy"))
    _child(parent, "pose", of if origin is None else origin, **attributes).text = f"{xyz} {rpy}"


def _shape(parent: Element, geometry: Element) -> None:
    """The shape in a URDF's <geometry>: its attributes are elements in SDF."""
    for shape in geometry:
        made = _child(parent, shape.tag, shape)
        for key, value in shape.attrib.items():
            _child(made, "uri" if key == "filename" else key, shape).text = value
