"""Parse XML files safely and read validated values from SDF elements, with errors that name file, line and element.

The grammar of SDF is that of http://sdformat.org/spec, versions 1.4 to 1.8.
"""

import math
import os
import re
from typing import Any, Iterable, Optional, Sequence, Set, Tuple
from urllib.parse import quote, unquote

from lxml import etree

from ...errors import WorldError
from ...geometry import Pose3D

VERSIONS = ("1.4", "1.5", "1.6", "1.7", "1.8")
Element = Any  # lxml.etree._Element, which is private and has no type hints

# float() alone would accept "1_000" and "infinity".
_NUMBER = re.compile(r"[+-]?(\d+\.?\d*|\.\d+)([eE][+-]?\d+)?", re.ASCII)
_BOOLEANS = {"true": True, "1": True, "false": False, "0": False}


def error(element: Element, message: str) -> WorldError:
    """The error to raise about an element: file:line, the model/link/collision that it is in, the message."""
    owners = [element, *element.iterancestors("model", "link", "collision")]
    names = [owner.get("name") for owner in reversed(owners) if owner.tag in ("model", "link", "collision")]
    where = "/".join(name or "?" for name in names)
    place = f"{file_of(element)}:{element.sourceline}"
    return WorldError(f"{place}: in '{where}': {message}" if where else f"{place}: {message}")


def file_of(element: Element) -> str:
    """The file that contains an element, by the path that it was read from."""
    return unquote(element.getroottree().docinfo.URL)


def read_root(path: str, expected: Sequence[str]) -> Element:
    """The only element within <sdf>; `expected` lists the tags it may have, such as world and model.

    WorldError if the file can't be read, is not XML, has a DOCTYPE, or is not SDF 1.4 to 1.8 with one such element.
    """
    return root_of(parse(path), expected)


def root_of(root: Element, expected: Sequence[str]) -> Element:
    """The only element within a parsed <sdf>; WorldError as read_root."""
    if root.tag != "sdf":
        raise error(root, f"the outermost element is <{root.tag}>, expected <sdf>")
    if root.get("version") not in VERSIONS:
        raise error(root, f"SDF version {root.get('version')!r} is not supported; supported: {', '.join(VERSIONS)}")
    require_known_children(root, read=expected)
    children = [child for child in root if child.tag in expected]
    if not children:
        raise error(root, f"<sdf> has no <{'> and no <'.join(expected)}>")
    if len(children) > 1:
        raise error(children[1], f"a second <{children[1].tag}> in <sdf>; supported: one")
    return children[0]


def parse(path: str) -> Element:
    """The root element of an XML file; WorldError if it can't be read, is not XML, or has a DOCTYPE."""
    try:
        # Not etree.parse(path), which would also accept a URL.
        with open(path, "rb") as file:
            return parse_text(file.read(), path)
    except OSError as exc:
        raise WorldError(f"{path}: can't read the file: {exc.strerror or exc}") from exc


def parse_text(text: bytes, path: str) -> Element:
    """The root element of an XML text; path: its name for messages. WorldError as parse."""
    # World files are not trusted: a DTD could include other files, or expand its entities without bound.
    parser = etree.XMLParser(
        resolve_entities=False, no_network=True, load_dtd=False, remove_comments=True, remove_pis=True
    )
    try:
        # Quoted here because libxml2 quotes only some paths; file_of unquotes it.
        root = etree.fromstring(text, parser, base_url=quote(os.fsencode(path)))
    except etree.XMLSyntaxError as exc:
        raise WorldError(f"{path}:{exc.lineno}: not well-formed XML: {exc.msg}") from exc
    info = root.getroottree().docinfo
    if info.doctype or info.internalDTD is not None:
        raise WorldError(f"{path}: '{info.doctype}' is not supported; expected a file without DOCTYPE and entities")
    return root


def require_known_children(element: Element, read: Iterable[str], skipped: Iterable[str] = ()) -> None:
    """WorldError for a child that is neither read nor deliberately skipped, so that misspelt tags are reported."""
    known = {*read, *skipped}
    for child in element:
        # SDF allows extensions in other XML namespaces.
        if child.tag not in known and not child.tag.startswith("{"):
            name = f" '{child.get('name')}'" if child.get("name") else ""
            raise error(
                child,
                f"<{child.tag}>{name} in <{element.tag}> is not supported; supported: {', '.join(sorted(read))}",
            )


def require_unique_names(elements: Iterable[Element]) -> None:
    """WorldError for the second of two elements with the same name."""
    used: Set[str] = set()
    for element in elements:
        claim_name(name_of(element), element, used)


def claim_name(name: str, element: Element, used: Set[str]) -> None:
    """Add an element's name to those in use; WorldError if it is already in use."""
    if name in used:
        raise error(element, f"the name '{name}' of this <{element.tag}> is already taken; expected another name")
    used.add(name)


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

    Gazebo accepts several, and the last one counts.
    """
    value = None
    for child in element.iterchildren(tag):
        text = text_of(child)
        if text.lower() not in _BOOLEANS:
            raise error(child, f"<{tag}> is '{text}', expected true or false")
        value = _BOOLEANS[text.lower()]
    return value


def numbers(element: Element, count: int) -> Tuple[float, ...]:
    """The element's `count` finite numbers, in SDF's units."""
    words = text_of(element).split()
    if len(words) == count and all(_NUMBER.fullmatch(word) for word in words):
        values = tuple(float(word) for word in words)
        if all(math.isfinite(value) for value in values):
            return values
    raise error(element, f"<{element.tag}> is '{' '.join(words)}', expected {_finite(count)}")


def sizes(element: Element, count: int) -> Tuple[float, ...]:
    """The element's `count` lengths [m], each greater than zero."""
    values = numbers(element, count)
    if min(values) <= 0.0:
        text = " ".join(text_of(element).split())
        raise error(element, f"<{element.tag}> is '{text}', expected {_finite(count)} greater than 0")
    return values


def _finite(count: int) -> str:
    return "one finite number" if count == 1 else f"{count} finite numbers"


def pose_numbers(element: Element) -> Tuple[float, ...]:
    """x, y, z [m], roll, pitch, yaw [rad] of the element's <pose> in the world; zeros if there is no <pose>.

    WorldError if the <pose> names another frame.
    """
    pose = optional_child(element, "pose")
    if pose is None:
        return (0.0,) * 6
    for key in ("frame", "relative_to"):
        if pose.get(key, "") not in ("", "world"):
            raise error(pose, f"<pose {key}='{pose.get(key)}'> is not supported here; supported: a pose in the world")
    return _pose_numbers(pose)


def _pose_numbers(pose: Element) -> Tuple[float, ...]:
    """Zeros for a <pose> without text, as `gz sdf` writes it for a link that coincides with its joint."""
    for key, value in pose.attrib.items():
        if key not in ("frame", "relative_to") and (key, _BOOLEANS.get(value.lower())) != ("degrees", False):
            raise error(pose, f"<pose {key}='{value}'> is not supported; supported: metres and radians")
    return numbers(pose, 6) if text_of(pose) else (0.0,) * 6


def pose_of(element: Element) -> Pose3D:
    """The element's <pose> in the world, as pose_numbers."""
    return _to_pose(pose_numbers(element))


def own_pose(element: Element) -> Pose3D:
    """The element's <pose> in whichever frame it is given; the identity if there is none."""
    pose = optional_child(element, "pose")
    return Pose3D() if pose is None else _to_pose(_pose_numbers(pose))


def _to_pose(values: Tuple[float, ...]) -> Pose3D:
    x, y, z, roll, pitch, yaw = values
    return Pose3D.from_xyz_rpy((x, y, z), (roll, pitch, yaw))
