"""Read a differential-drive robot from its URDF."""

import copy
import os
from typing import List, Optional

from lxml import etree

from ..errors import RobotModelError
from ..geometry import Pose2D, Pose3D, Vector3, compose3
from ..reading import Element, finite_numbers, parse_xml, reading
from ..shapes import Box, Cylinder, Geometry, PlacedShape, Sphere
from .model import BASE, CAMERA_FRAME, WHEEL_JOINTS, ModelFigures, RobotModel

_SIZES = ("box", "cylinder", "sphere")
# What holds numbers in links and joints: each tag's attributes, and how many numbers each attribute has.
_NUMBERS = {
    "box": {"size": 3},
    "cylinder": {"radius": 1, "length": 1},
    "sphere": {"radius": 1},
    "axis": {"xyz": 3},
    "inertia": {"ixx": 1, "ixy": 1, "ixz": 1, "iyy": 1, "iyz": 1, "izz": 1},
    "mass": {"value": 1},
    "origin": {"xyz": 3, "rpy": 3},
}


def load_robot(path: str, figures: ModelFigures) -> RobotModel:
    """Read a URDF file; RobotModelError names the file and the link, joint, shape or number that is wrong."""
    with reading(path, RobotModelError, "a URDF"):
        with open(path, "rb") as stream:
            urdf = _Urdf(parse_xml(stream.read(), path, RobotModelError), path)
        footprint_from_base = urdf.pose_of(BASE)
        if footprint_from_base.on_plane() != Pose2D():
            raise urdf.error(f"link {BASE!r}: expected it directly above base_footprint and facing the same way")
        left, right = (urdf.joint(name) for name in WHEEL_JOINTS)
        return RobotModel(
            name=urdf.root.get("name") or os.path.splitext(os.path.basename(path))[0],
            physics_urdf=urdf.for_physics(),
            wheel_radius=urdf.wheel_radius(left),
            wheel_separation=urdf.wheel_separation(left, right),
            footprint_from_base=footprint_from_base,
            base_from_scan=urdf.pose_of("base_scan", BASE),
            base_from_imu=urdf.pose_of("imu_link", BASE),
            base_from_camera=urdf.pose_of(CAMERA_FRAME, BASE) if CAMERA_FRAME in urdf.joint_to else None,
            collisions=tuple(urdf.collisions()),
            figures=figures,
        )


def vector(text: str) -> Vector3:
    """Three numbers of a URDF; ValueError for anything else."""
    x, y, z = (float(word) for word in text.split())
    return (x, y, z)


def origin_of(element: Element) -> Pose3D:
    """The <origin> of a joint, collision, visual or inertial; the identity if it has none."""
    origin = element.find("origin")
    if origin is None:
        return Pose3D()
    return Pose3D.from_xyz_rpy(vector(origin.get("xyz", "0 0 0")), vector(origin.get("rpy", "0 0 0")))


def primitive(geometry: Element) -> Optional[Geometry]:
    """The box, cylinder or sphere that an element of a <geometry> is; None for another one."""
    if geometry.tag == "box":
        return Box(vector(geometry.get("size", "")))
    if geometry.tag == "cylinder":
        return Cylinder(float(geometry.get("radius", "")), float(geometry.get("length", "")))
    return Sphere(float(geometry.get("radius", ""))) if geometry.tag == "sphere" else None


def _end_of(joint: Element, end: str) -> str:
    """The name of a joint's "parent" or "child" link; empty if the joint names none."""
    element = joint.find(end)
    return "" if element is None else str(element.get("link", ""))


class _Urdf:
    """A URDF tree whose numbers have been checked, with its joints by name and by child link."""

    def __init__(self, root: Element, path: str) -> None:
        self.root = root
        self.path = path
        self.joints = {joint.get("name"): joint for joint in root.findall("joint")}
        self.joint_to = {_end_of(joint, "child"): joint for joint in root.findall("joint")}
        for element in (*root.iterfind("link//*"), *root.iterfind("joint//*")):
            for name, count in _NUMBERS.get(element.tag, {}).items():
                self.check_numbers(element, name, count)

    def error(self, what: str) -> RobotModelError:
        return RobotModelError(f"{self.path}: {what}")

    def check_numbers(self, element: Element, name: str, count: int) -> None:
        """RobotModelError unless an attribute holds so many finite numbers; sizes are required and positive."""
        is_size = element.tag in _SIZES
        text = element.get(name, "" if is_size else None)
        try:
            if text is not None:
                finite_numbers(text, count, positive=is_size)
        except ValueError as exc:
            raise self.error(f"line {element.sourceline}: <{element.tag}> has {name}={text!r}, {exc}") from exc

    def joint(self, name: str) -> Element:
        if name not in self.joints:
            raise self.error(f"no joint {name!r}; found: {', '.join(sorted(self.joints)) or 'none'}")
        return self.joints[name]

    def link(self, name: str) -> Element:
        for link in self.root.findall("link"):
            if link.get("name") == name:
                return link
        raise self.error(f"no link {name!r}")

    def pose_of(self, link: str, root: str = "base_footprint") -> Pose3D:
        """root_from_link, wheels at angle zero."""
        self.link(link)
        pose, ancestor = Pose3D(), link
        for _ in range(len(self.joint_to) + 1):  # a tree has no longer chain; joints in a circle have
            if ancestor == root:
                return pose
            if ancestor not in self.joint_to:
                break
            joint = self.joint_to[ancestor]
            pose = compose3(origin_of(joint), pose)
            ancestor = _end_of(joint, "parent")
        raise self.error(f"no joints lead from link {link!r} to link {root!r}")

    def collisions(self) -> List[PlacedShape]:
        """All collision shapes of links with mass, with poses in base_footprint."""
        return [
            PlacedShape(
                f"{link.get('name')}/{number}",
                compose3(self.pose_of(link.get("name")), origin_of(collision)),
                self.shape(link, collision),
            )
            for link in self.root.findall("link")
            if link.find("inertial") is not None
            for number, collision in enumerate(link.findall("collision"))
        ]

    def shape(self, link: Element, collision: Element) -> Geometry:
        """The geometry of a <collision>: a box, a cylinder or a sphere."""
        for element in collision.iterfind("geometry/*"):
            shape = primitive(element)
            if shape is not None:
                return shape
        raise self.error(f"link {link.get('name')!r}: expected a box, a cylinder or a sphere as its collision geometry")

    def wheel_radius(self, joint: Element) -> float:
        """The radius [m] of the wheel's collision sphere, which rolls on the floor."""
        link = _end_of(joint, "child")
        sphere = self.link(link).find("collision/geometry/sphere")
        if sphere is None:
            raise self.error(f"link {link!r} needs a sphere as its collision geometry, for the wheel's radius")
        return float(sphere.get("radius"))

    def wheel_separation(self, left: Element, right: Element) -> float:
        """The distance [m] between the joints of the wheels along the base's y axis."""
        separation = origin_of(left).position[1] - origin_of(right).position[1]
        if separation <= 0.0:
            raise self.error("expected {!r} to the left of {!r}".format(*WHEEL_JOINTS))
        return separation

    def for_physics(self) -> str:
        """The tree rooted at BASE, without massless links: pybullet would give each of them a mass of one kilogram."""
        root = copy.deepcopy(self.root)
        massless = [link for link in root.findall("link") if link.find("inertial") is None]
        names = [link.get("name") for link in massless]
        if BASE in names:
            raise self.error(f"link {BASE!r} has no <inertial>")
        cut = [
            joint for joint in root.findall("joint") if {_end_of(joint, "child"), _end_of(joint, "parent")} & {*names}
        ]
        visuals = [visual for visual in root.findall("link/visual") if visual.find("geometry/mesh") is not None]
        for element in (*massless, *cut, *visuals):
            element.getparent().remove(element)
        return etree.tostring(root, encoding="unicode")
