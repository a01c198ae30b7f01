"""Differential-drive robots: their models, read from URDF, and their states."""

import copy
import os
from dataclasses import dataclass
from typing import Dict, List, NamedTuple, Optional, Tuple

from lxml import etree

from ..errors import RobotModelError
from ..geometry import Pose2D, Pose3D, Twist2D, Vector3, compose3
from ..world.model import Box, Cylinder, Geometry, Obstacle, Sphere
from .model_figures import ModelFigures

WHEEL_JOINTS = ("wheel_left_joint", "wheel_right_joint")  # as the TurtleBot3 drivers name them
CASTER_PREFIX = "caster"
CAMERA_FRAME = "camera_rgb_optical_frame"  # as the TurtleBot3's camera in Gazebo names it

Pair = Tuple[float, float]  # left and right wheel


@dataclass(frozen=True)
class RobotModel:
    """A differential-drive robot; base is base_link, footprint is base_footprint on the floor between the wheels."""

    name: str
    urdf: str  # the complete description, for robot_state_publisher
    physics_urdf: str  # the same, rooted at base_link and without massless links and visual meshes
    wheel_radius: float  # [m]
    wheel_separation: float  # [m]
    footprint_from_base: Pose3D
    base_from_scan: Pose3D
    base_from_imu: Pose3D
    base_from_camera: Optional[Pose3D]  # the optical frame; None: no camera
    collisions: Tuple[Obstacle, ...]  # of all links with mass, poses in base_footprint, wheels at angle zero
    figures: ModelFigures

    @property
    def scan_height(self) -> float:
        """Height of the scanner above the floor [m]."""
        return self.footprint_from_base.position[2] + self.base_from_scan.position[2]


@dataclass(frozen=True)
class RobotSpec:
    """One robot of a simulation.

    name: its ROS namespace; empty for a single robot
    spawn: world_from_footprint at the start
    """

    name: str
    model: RobotModel
    spawn: Pose2D


class RobotState(NamedTuple):
    """A robot after one step, seen from above. A NamedTuple, because a new one is created in every step."""

    world_from_footprint: Pose2D
    twist: Twist2D  # true velocity in base_footprint
    wheel_angles: Pair  # left, right [rad], never wrapped
    wheel_velocities: Pair  # left, right [rad/s]


@dataclass(frozen=True)
class BodyState:
    """A robot's base_link in space; velocities are in the world frame."""

    world_from_base: Pose3D
    linear_velocity: Vector3  # [m/s]
    angular_velocity: Vector3  # [rad/s]


def load_robot(
    path: str, figures: ModelFigures, base: str = "base_link", scan: str = "base_scan", imu: str = "imu_link"
) -> RobotModel:
    """Read a URDF file; RobotModelError names the file and the link, joint or shape that is missing or wrong."""
    parser = etree.XMLParser(resolve_entities=False, no_network=True, load_dtd=False, remove_comments=True)
    try:
        with open(path, "rb") as stream:
            root = etree.fromstring(stream.read(), parser)
    except (OSError, etree.XMLSyntaxError) as error:
        raise RobotModelError(f"{path}: {error}") from error
    reader = _Reader(root, path)
    footprint_from_base = reader.pose_of(base)
    if footprint_from_base.on_plane() != Pose2D():
        raise reader.fail(f"link {base!r}: expected it directly above base_footprint and facing the same way")
    wheels = [reader.joint(name) for name in WHEEL_JOINTS]
    return RobotModel(
        name=root.get("name") or os.path.splitext(os.path.basename(path))[0],
        urdf=etree.tostring(root, encoding="unicode"),
        physics_urdf=reader.physics_urdf(base),
        wheel_radius=reader.wheel_radius(wheels[0]),
        wheel_separation=_origin(wheels[0]).position[1] - _origin(wheels[1]).position[1],
        footprint_from_base=footprint_from_base,
        base_from_scan=reader.pose_of(scan, base),
        base_from_imu=reader.pose_of(imu, base),
        base_from_camera=reader.pose_of(CAMERA_FRAME, base) if CAMERA_FRAME in reader.by_child else None,
        collisions=tuple(reader.collisions()),
        figures=figures,
    )


def _vector(text: str) -> Vector3:
    x, y, z = (float(word) for word in text.split())
    return (x, y, z)


def _origin(element: "etree._Element") -> Pose3D:
    """The <origin> of a joint or collision; the identity if it has none."""
    origin = element.find("origin")
    if origin is None:
        return Pose3D()
    return Pose3D.from_xyz_rpy(_vector(origin.get("xyz", "0 0 0")), _vector(origin.get("rpy", "0 0 0")))


def _attribute(element: "etree._Element", child: str, name: str) -> str:
    child_element = element.find(child)
    return "" if child_element is None else child_element.get(name, "")


class _Reader:
    """A URDF tree with its joints indexed by name and by child link."""

    def __init__(self, root: "etree._Element", path: str) -> None:
        self.root = root
        self.path = path
        self.by_name: Dict[str, etree._Element] = {joint.get("name"): joint for joint in root.findall("joint")}
        self.by_child = {_attribute(joint, "child", "link"): joint for joint in root.findall("joint")}

    def fail(self, what: str) -> RobotModelError:
        return RobotModelError(f"{self.path}: {what}")

    def joint(self, name: str) -> "etree._Element":
        if name not in self.by_name:
            raise self.fail("no joint {!r}; found: {}".format(name, ", ".join(sorted(self.by_name)) or "none"))
        return self.by_name[name]

    def link(self, name: str) -> "etree._Element":
        for link in self.root.findall("link"):
            if link.get("name") == name:
                return link
        raise self.fail(f"no link {name!r}")

    def pose_of(self, link: str, root: str = "base_footprint") -> Pose3D:
        """root_from_link, wheels at angle zero."""
        self.link(link)
        pose = Pose3D()
        while link != root:
            if link not in self.by_child:
                raise self.fail(f"no joints lead from link {link!r} to link {root!r}")
            joint = self.by_child[link]
            pose = compose3(_origin(joint), pose)
            link = _attribute(joint, "parent", "link")
        return pose

    def collisions(self) -> List[Obstacle]:
        """All collision shapes of links with mass, with poses in base_footprint."""
        collisions = []
        for link in self.root.findall("link"):
            for number, collision in enumerate(link.findall("collision") if link.find("inertial") is not None else ()):
                pose = compose3(self.pose_of(link.get("name")), _origin(collision))
                collisions.append(Obstacle(f"{link.get('name')}/{number}", pose, self.shape(link, collision)))
        return collisions

    def shape(self, link: "etree._Element", collision: "etree._Element") -> Geometry:
        """The geometry of a <collision>: a box, a cylinder or a sphere."""
        for shape in collision.iterfind("geometry/*"):
            if shape.tag == "box":
                return Box(_vector(shape.get("size")))
            if shape.tag == "cylinder":
                return Cylinder(float(shape.get("radius")), float(shape.get("length")))
            if shape.tag == "sphere":
                return Sphere(float(shape.get("radius")))
        raise self.fail(f"link {link.get('name')!r}: expected a box, a cylinder or a sphere as its collision geometry")

    def wheel_radius(self, joint: "etree._Element") -> float:
        """The radius of the wheel's collision sphere, which is what rolls on the floor."""
        link = _attribute(joint, "child", "link")
        sphere = self.link(link).find("collision/geometry/sphere")
        if sphere is None:
            raise self.fail(f"link {link!r} needs a sphere as its collision geometry, for the wheel's radius")
        return float(sphere.get("radius"))

    def physics_urdf(self, base: str) -> str:
        """The tree rooted at `base` without massless links, to which pybullet would give a mass of one kilogram."""
        root = copy.deepcopy(self.root)
        massless: List[str] = []
        for link in root.findall("link"):
            if link.find("inertial") is None:
                massless.append(link.get("name"))
                root.remove(link)
        if base in massless:
            raise self.fail(f"link {base!r} has no <inertial>")
        for joint in root.findall("joint"):
            if _attribute(joint, "child", "link") in massless or _attribute(joint, "parent", "link") in massless:
                root.remove(joint)
        for visual in root.findall("link/visual"):
            if visual.find("geometry/mesh") is not None:
                visual.getparent().remove(visual)
        return etree.tostring(root, encoding="unicode")
