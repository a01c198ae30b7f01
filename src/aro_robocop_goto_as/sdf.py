"""SDF file -> its elements, every value checked where it stands.

The lower half of the world reader: it knows SDF's grammar but nothing of worlds; world.py makes a World of it.
The grammar is that of http://sdformat.org/spec, versions 1.4 to 1.7.
"""

import math
import os
import re
from typing import Any, Iterable, Optional, Sequence, Set, Tuple
from urllib.parse import quote, unquote

from lxml import etree

from aro_robocop_goto_as.errors import WorldError
from aro_robocop_goto_as.geometry import Pose3D

VERSIONS = ("1.4", "1.5", "1.6", "1.7")
Element = Any  # lxml.etree._Element, which lxml neither types nor makes public

# float() alone would let "1_000" and "infinity" pass.
_NUMBER = re.compile(r"[+-]?(\d+\.?\d*|\.\d+)([eE][+-]?\d+)?", re.ASCII)
_FRAME_OF = {"world": "world", "model": "__model__"}  # what SDF calls the frame that an element makes for those in it
_BOOLEANS = {"true": True, "1": True, "false": False, "0": False}


def error(element: Element, message: str) -> WorldError:
    """The error to raise about an element: file:line, the model/link/collision it belongs to, the message."""
    owners = [element, *element.iterancestors("model", "link", "collision")]
    names = [owner.get("name") for owner in reversed(owners) if owner.tag in ("model", "link", "collision")]
    where = "/".join(name or "?" for name in names)
    place = f"{file_of(element)}:{element.sourceline}"
    return WorldError(f"{place}: in '{where}': {message}" if where else f"{place}: {message}")


def file_of(element: Element) -> str:
    """The file that an element stands in, as its path was given."""
    return unquote(element.getroottree().docinfo.URL)


def read_root(path: str, expected: Sequence[str]) -> Element:
    """The one element within <sdf>, which must be one of those expected: <world>, <model>.

    Raises WorldError if the file can't be read, isn't XML, declares a DOCTYPE, or isn't one such of SDF 1.4 to 1.7.
    """
    return root_of(parse(path), expected)


def root_of(root: Element, expected: Sequence[str]) -> Element:
    """The one element within an <sdf> that is parsed already; WorldError as read_root."""
    if root.tag != "sdf":
        raise error(root, f"the outermost element is <{root.tag}>, expected <sdf>")
    if root.get("version") not in VERSIONS:
        raise error(root, f"SDF version {root.get('version')!r} is not supported; supported: {', '.join(VERSIONS)}")
    check_children(root, read=expected)
    found = [child for child in root if child.tag in expected]
    if not found:
        raise error(root, f"<sdf> has no <{'> and no <'.join(expected)}>")
    if len(found) > 1:
        raise error(found[1], f"a second <{found[1].tag}> in <sdf>; supported: one")
    return found[0]


def parse(path: str) -> Element:
    """The outermost element of an XML file; WorldError if it can't be read, isn't XML, or declares a DOCTYPE."""
    try:
        # Not etree.parse(path), which would take a URL for a path as well.
        with open(path, "rb") as file:
            return parse_text(file.read(), path)
    except OSError as exc:
        raise WorldError(f"{path}: can't read the file: {exc.strerror or exc}") from exc


def parse_text(text: bytes, path: str) -> Element:
    """`parse` for what has been read already; path: what messages call it."""
    # Worlds come from strangers: a DTD could read other files, or grow without bound when its entities expand.
    parser = etree.XMLParser(
        resolve_entities=False, no_network=True, load_dtd=False, remove_comments=True, remove_pis=True
    )
    try:
        # Quoted, or libxml2 quotes it only at times.
        root = etree.fromstring(text, parser, base_url=quote(os.fsencode(path)))
    except etree.XMLSyntaxError as exc:
        raise WorldError(f"{path}:{exc.lineno}: not well-formed XML: {exc.msg}") from exc
    info = root.getroottree().docinfo
    if info.doctype or info.internalDTD is not None:
        raise WorldError(f"{path}: '{info.doctype}' is not supported; a world's files hold no DOCTYPE and no entities")
    return root


def check_children(element: Element, read: Iterable[str], skipped: Iterable[str] = ()) -> None:
    """Refuse any child that is neither read nor knowingly skipped, so that a misspelt one can't vanish."""
    known = {*read, *skipped}
    for child in element:
        # SDF leaves elements of foreign namespaces to whom they concern.
        if child.tag not in known and not child.tag.startswith("{"):
            name = f" '{child.get('name')}'" if child.get("name") else ""
            raise error(
                child,
                f"<{child.tag}>{name} in <{element.tag}> is not supported; supported: {', '.join(sorted(read))}",
            )


def check_unique(elements: Iterable[Element]) -> None:
    """Refuse the second of two siblings with the same name; their obstacles couldn't be told apart."""
    taken: Set[str] = set()
    for element in elements:
        claim(name_of(element), element, taken)


def claim(name: str, element: Element, taken: Set[str]) -> None:
    """Add an element's name to those that are taken; WorldError if it is among them."""
    if name in taken:
        raise error(element, f"the name '{name}' of this <{element.tag}> is taken by an earlier one")
    taken.add(name)


def only(element: Element, tag: str) -> Optional[Element]:
    """The child with this tag, or None; WorldError if there are several."""
    found = element.findall(tag)
    if len(found) > 1:
        raise error(found[1], f"a second <{tag}> in <{element.tag}>; supported: one")
    return found[0] if found else None


def need(element: Element, tag: str) -> Element:
    """The child with this tag; WorldError if there is none, or if there are several."""
    child = only(element, tag)
    if child is None:
        raise error(element, f"<{element.tag}> has no <{tag}>")
    return child


def text_of(element: Element) -> str:
    """The element's text, stripped; WorldError if it holds other elements."""
    if len(element):
        raise error(element[0], f"<{element[0].tag}> in <{element.tag}>, expected text only")
    return (element.text or "").strip()


def name_of(element: Element) -> str:
    """The attribute `name`, stripped; WorldError if there is none."""
    name = str(element.get("name", "")).strip()
    if not name:
        raise error(element, f"<{element.tag}> has no name")
    return name


def boolean(element: Element, tag: str, default: bool) -> bool:
    """The child's truth value (true, false, 1 or 0), or the default if there is no such child."""
    child = only(element, tag)
    if child is None:
        return default
    text = text_of(child)
    if text.lower() not in _BOOLEANS:
        raise error(child, f"<{tag}> is '{text}', expected true or false")
    return _BOOLEANS[text.lower()]


def numbers(element: Element, count: int) -> Tuple[float, ...]:
    """The element's `count` finite numbers, in the unit SDF gives them."""
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
    """x, y, z [m], roll, pitch, yaw [rad] of the element's <pose> in its parent's frame; zeros if there is none.

    WorldError if the pose says that it is in another frame; it may name the parent's own.
    """
    pose = only(element, "pose")
    if pose is None:
        return (0.0,) * 6
    for key, value in pose.attrib.items():
        # Gazebo 9 writes frame='', which means the parent's frame as does no attribute at all.
        if key not in ("frame", "relative_to") or value not in ("", _FRAME_OF.get(_owner_of_frame(element), "")):
            raise error(pose, f"<pose {key}='{value}'> is not supported; supported: a pose in the parent's frame")
    return numbers(pose, 6)


def _owner_of_frame(element: Element) -> str:
    """The tag of what an element's pose is in: of the parent, but in a <state> all poses are in the world."""
    if next(element.iterancestors("state"), None) is not None:
        return "world"
    parent = element.getparent()
    return "" if parent is None else str(parent.tag)


def pose_of(element: Element) -> Pose3D:
    """The element's <pose> in its parent's frame; the identity if there is none."""
    x, y, z, roll, pitch, yaw = pose_numbers(element)
    return Pose3D.from_xyz_rpy((x, y, z), (roll, pitch, yaw))
