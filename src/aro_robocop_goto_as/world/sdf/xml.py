"""Read validated values from SDF elements, with errors that name file, line and element.

The grammar of SDF is that of http://sdformat.org/spec, version 1.4 and later.
"""

import math
import re
from contextlib import contextmanager
from typing import Iterable, Iterator, List, Optional, Sequence, Tuple

from ...errors import WorldError
from ...geometry import MAX_COORDINATE, Pose3D
from ...reading import Element, file_of, finite_numbers, parse_xml, reading

OLDEST = 4  # of SDF 1.4, 1.5, ...
_BOOLEANS = {"true": True, "1": True, "false": False, "0": False}


def error(element: Element, message: str) -> WorldError:
    """The error to raise about an element: file:line, the model/link/collision that it is in, the message."""
    owners = [element, *element.iterancestors("model", "link", "collision")]
    names = [owner.get("name") for owner in reversed(owners) if owner.tag in ("model", "link", "collision")]
    where = "/".join(name or "?" for name in names)
    place = f"{file_of(element)}:{element.sourceline}"
    return WorldError(f"{place}: in '{where}': {message}" if where else f"{place}: {message}")


class NotSimulatedError(WorldError):
    """An element, mesh or URI is not simulated, so its element is left out; the message begins with its name."""


class MissingModelError(NotSimulatedError):
    """The folder of a model is nowhere on this machine; the message lists the places searched."""

    def __init__(self, name: str, message: str) -> None:
        super().__init__(message)
        self.name = name  # of the model


@contextmanager
def about(element: Element) -> Iterator[None]:
    """Raise a WorldError of this block as an error about an element."""
    try:
        yield
    except NotSimulatedError:
        raise
    except WorldError as exc:
        raise error(element, str(exc)) from exc


def root_of(root: Element, expected: Sequence[str]) -> Element:
    """The only element within a parsed <sdf>; `expected` lists the tags it may have, such as world and model.

    WorldError if it is not SDF 1.4 or later with one such element.
    """
    if root.tag != "sdf":
        raise error(root, f"the outermost element is <{root.tag}>, expected <sdf>")
    if version_of(root) < OLDEST:
        raise error(root, f"SDF version {root.get('version')!r} is not supported; supported: 1.{OLDEST} and later")
    children = [child for child in root if child.tag in expected]
    if not children:
        raise error(root, f"<sdf> has no <{'> and no <'.join(expected)}>")
    if len(children) > 1:
        raise error(children[1], f"a second <{children[1].tag}> in <sdf>; supported: one")
    return children[0]


def version_of(element: Element) -> int:
    """N of the SDF version 1.N that an element says it has; 0 if it says another one, or none."""
    version = re.fullmatch(r"1\.(\d{1,9})", element.get("version", ""), re.ASCII)
    return int(version[1]) if version else 0


def parse(path: str, lenient: bool = False) -> Element:
    """The root element of an XML file, see parse_xml; WorldError if it can't be read, is not XML, or has a DOCTYPE."""
    # Not etree.parse(path), which would also accept a URL.
    with reading(path, WorldError, "an XML file"), open(path, "rb") as file:
        return parse_xml(file.read(), path, WorldError, lenient)


def unknown_children(element: Element, known: Iterable[str]) -> List[Element]:
    """The children with other tags; SDF allows extensions in other XML namespaces, which do not count."""
    tags = {*known}
    return [child for child in element if child.tag not in tags and not child.tag.startswith("{")]


def title_of(element: Element) -> str:
    """An element's tag, and its name if it has one, for a message."""
    return f"<{element.tag}>" + (f" '{element.get('name')}'" if element.get("name") else "")


def optional_child(element: Element, tag: str) -> Optional[Element]:
    """The child with this tag, or None; WorldError if there are several."""
    children = element.findall(tag)
    if len(children) > 1:
        raise error(children[1], f"a second <{tag}> in <{element.tag}>; supported: one")
    return children[0] if children else None


def required_child(element: Element, tag: str) -> Element:
    """The child with this tag; WorldError if there is none or if there are several."""
    child = optional_child(element, tag)
    if child is None:
        raise error(element, f"<{element.tag}> has no <{tag}>")
    return child


def text_of(element: Element) -> str:
    """The element's text, stripped; WorldError if it contains other elements."""
    if len(element):
        raise error(element[0], f"<{element[0].tag}> in <{element.tag}>, expected text only")
    return (element.text or "").strip()


def name_of(element: Element) -> str:
    """The attribute `name`, stripped; WorldError if there is none."""
    name = str(element.get("name", "")).strip()
    if not name:
        raise error(element, f"<{element.tag}> has no name")
    return name


def boolean(element: Element, tag: str) -> Optional[bool]:
    """The value (true, false, 1 or 0) of the last child with this tag, or None if there is no such child.

    Gazebo accepts several children, and the last one counts.
    """
    value = None
    for child in element.iterchildren(tag):
        text = text_of(child)
        if text.lower() not in _BOOLEANS:
            raise error(child, f"<{tag}> is '{text}', expected true or false")
        value = _BOOLEANS[text.lower()]
    return value


def numbers(element: Element, count: int, positive: bool = False, largest: float = MAX_COORDINATE) -> Tuple[float, ...]:
    """The element's `count` finite numbers, in SDF's units, all within +-largest."""
    text = " ".join(text_of(element).split())
    try:
        values = finite_numbers(text, count, positive)
    except ValueError as exc:
        raise error(element, f"<{element.tag}> is '{text}', {exc}") from exc
    if not all(abs(value) <= largest for value in values):
        raise error(element, f"<{element.tag}> is '{text}', expected numbers within +-{largest:g}")
    return values


def pose_of(element: Element, largest: float = MAX_COORDINATE) -> Pose3D:
    """The element's <pose> in whichever frame it is given; the identity without a <pose>, or without text in it.

    `gz sdf` writes a <pose> without text for a link that coincides with its joint.
    """
    pose = optional_child(element, "pose")
    if pose is None or not text_of(pose):
        return Pose3D()
    if pose.get("rotation_format") == "quat_xyzw":
        x, y, z, *quaternion = numbers(pose, 7, largest=largest)
        length = math.hypot(*quaternion)
        if not length:
            raise error(pose, f"<pose> is '{text_of(pose)}', expected a quaternion that is not zero")
        qx, qy, qz, qw = (part / length for part in quaternion)
        return Pose3D((x, y, z), (qx, qy, qz, qw))
    x, y, z, *angles = numbers(pose, 6, largest=largest)
    roll, pitch, yaw = map(math.radians, angles) if _BOOLEANS.get(pose.get("degrees", "").lower()) else angles
    return Pose3D.from_xyz_rpy((x, y, z), (roll, pitch, yaw))


def pose_in_world(element: Element, largest: float = MAX_COORDINATE) -> Pose3D:
    """As pose_of; WorldError if the <pose> names a frame other than the world."""
    pose = optional_child(element, "pose")
    for key in ("frame", "relative_to"):
        if pose is not None and pose.get(key, "") not in ("", "world"):
            raise error(pose, f"<pose {key}='{pose.get(key)}'> is not supported here; supported: a pose in the world")
    return pose_of(element, largest)
