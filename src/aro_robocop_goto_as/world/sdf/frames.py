"""Resolve the poses of SDF elements, which may be relative to a frame other than their parent's (SDF 1.7 and later)."""

from typing import Tuple

from ...geometry import Pose3D, compose3, inverse3
from ...reading import Element
from . import xml

_OWN_FRAME = {"sdf": "world", "world": "world", "model": "__model__"}  # SDF's name for an element's own frame
_NAMED = ("frame", "include", "joint", "link", "model")  # children of a world or a model that a pose can be relative to
MAX_CHAIN = 100  # of poses, each relative to the next

Chain = Tuple[Element, ...]  # elements whose poses are being resolved


def placed(element: Element, world_from_parent: Pose3D) -> Pose3D:
    """world_from_element of a model, include, link or collision, by its <pose> and the frame that the <pose> names.

    WorldError if that frame is unknown or defined by itself.
    """
    (_, name), scope = _frame_of(element), element.getparent()
    if name == "world":
        return xml.pose_in_world(element)
    if scope is None or scope.tag != "link":
        return compose3(world_from_parent, _in_scope(element, ()))
    if not name:
        return compose3(world_from_parent, xml.pose_of(element))
    # The collision of a link; what its frame is named after is beside the link.
    model_from_frame = Pose3D() if name == "__model__" else _referred(element, name, scope.getparent(), ())
    world_from_model = compose3(world_from_parent, inverse3(_in_scope(scope, ())))
    return compose3(world_from_model, compose3(model_from_frame, xml.pose_of(element)))


def _in_scope(element: Element, chain: Chain) -> Pose3D:
    """The pose of a child of a world or a model, in the frame of that world or model."""
    if element in chain:
        raise xml.error(element, f"the pose of <{element.tag} name='{_name(element)}'> is relative to itself")
    if len(chain) >= MAX_CHAIN:
        raise xml.error(element, f"more than {MAX_CHAIN} poses relative to one another; supported: {MAX_CHAIN}")
    (_, name), pose, scope = _frame_of(element), xml.pose_of(element), element.getparent()
    if scope is None or name in ("", _OWN_FRAME.get(str(scope.tag), "")):
        return pose
    return compose3(_referred(element, name, scope, (*chain, element)), pose)


def _frame_of(element: Element) -> Tuple[str, str]:
    """How an element names the frame that its <pose> is given in, for messages, and that frame's name, or empty."""
    pose = xml.optional_child(element, "pose")
    for key in ("relative_to", "frame"):
        # Gazebo Classic 9 writes frame='', which means the parent's frame, as an absent attribute does.
        name = "" if pose is None else str(pose.get(key, ""))
        if name:
            return f"<pose {key}='{name}'>", name
    if element.tag == "frame":
        return f"<frame attached_to='{element.get('attached_to')}'>", str(element.get("attached_to", ""))
    if element.tag == "joint":
        child = xml.text_of(xml.required_child(element, "child"))
        return f"<child>{child}</child>", child
    return "", ""


def _referred(element: Element, name: str, scope: Element, chain: Chain) -> Pose3D:
    """Pose of what a <pose> is relative to, in the frame of the world or model `scope`; model::link is in a model."""
    first, _, inner = name.partition("::")
    for sibling in [] if scope is None else scope.iterchildren(*_NAMED):
        if _name(sibling) == first and (not inner or sibling.tag == "model"):
            if sibling.tag == "include" and xml.optional_child(sibling, "pose") is None:
                raise xml.error(element, f"'{name}' is an <include> without <pose>; supported: one that has a <pose>")
            scope_from_sibling = _in_scope(sibling, chain)
            return (
                compose3(scope_from_sibling, _referred(element, inner, sibling, chain)) if inner else scope_from_sibling
            )
    pose = xml.optional_child(element, "pose")
    raise xml.error(
        element if pose is None else pose,
        f"{_frame_of(element)[0]} is not supported; supported: a pose in the parent's frame, or relative_to the world, "
        "or to a <link>, <model>, <joint>, <frame> or named <include> beside it, or within a <model> beside it",
    )


def _name(element: Element) -> str:
    """An element's name; an include's is its <name>."""
    if element.tag == "include":
        name = xml.optional_child(element, "name")
        return "" if name is None else xml.text_of(name)
    return str(element.get("name", "")).strip()
