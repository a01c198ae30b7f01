"""Read the <state> that Gazebo saves with a world: where its models and links were at that time."""

import math
from typing import Callable, Dict, Iterator, Tuple

from ...geometry import MAX_COORDINATE, Pose3D
from ...reading import Element
from . import xml

_KNOWN = ("deletions", "insertions", "iterations", "light", "model", "real_time", "sim_time", "wall_time")
_KNOWN_OF_MODELS = tuple("acceleration collision joint link model pose scale static velocity wrench".split())

Note = Callable[[str, Element, bool], None]  # of what differs, the element, True
SavedPoses = Dict[str, Pose3D]  # of models and links, by name, in the world


def state_poses(world: Element, note: Note) -> SavedPoses:
    """The poses in a world's <state> elements, which override those of its models and links, as in Gazebo.

    Names are `model`, `model/link`, `model/nested`. Scales are noted and left out: Gazebo saves them in addition
    to shapes that are already scaled. Models that a state adds or removes are also noted and left out.
    """
    poses: SavedPoses = {}
    for state in world.iterchildren("state"):
        changes = [change for change in state.iterchildren("insertions", "deletions") if len(change) or change.text]
        for child in [*xml.unknown_children(state, _KNOWN), *changes]:
            note(f"{xml.title_of(child)} in <state> is left out", child, True)
        poses.update(_poses(state, "", note))
    return poses


def _poses(parent: Element, prefix: str, note: Note) -> Iterator[Tuple[str, Pose3D]]:
    for element in parent.iterchildren("model", "link"):
        for child in xml.unknown_children(element, _KNOWN_OF_MODELS):
            note(f"{xml.title_of(child)} in a <{element.tag}> of <state> is left out", child, True)
        name = prefix + xml.name_of(element)
        scale = xml.optional_child(element, "scale")
        if scale is not None and xml.numbers(scale, 3) != (1.0, 1.0, 1.0):
            note(f"<scale> {xml.text_of(scale)} in the state of '{name}' is left out", scale, True)
        if xml.optional_child(element, "pose") is not None:
            yield name, _within_reach(xml.pose_in_world(element, math.inf))
        yield from _poses(element, name + "/", note)


def _within_reach(pose: Pose3D) -> Pose3D:
    """The pose with its position within MAX_COORDINATE; Gazebo saves a model that has fallen for minutes as it is."""
    x, y, z = (max(-MAX_COORDINATE, min(MAX_COORDINATE, value)) for value in pose.position)
    return Pose3D((x, y, z), pose.orientation)
