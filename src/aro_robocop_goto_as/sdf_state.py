"""The <state> that Gazebo saves with a world -> where models and links were when it did."""

from typing import Dict, Iterator, Tuple

from . import sdf
from .geometry import Pose3D

Saved = Dict[str, Tuple[Pose3D, sdf.Element]]  # by the name of a model or link: its pose in the world, and its element


def state_poses(world: sdf.Element) -> Saved:
    """The poses that a world's <state> elements give, which Gazebo puts in place of the models' own.

    Names are `model`, `model/link`, `model/nested`. WorldError where a state scales, adds or removes something.
    """
    found: Saved = {}
    for state in world.iterchildren("state"):
        sdf.check_children(state, ("model",), ("iterations", "light", "real_time", "sim_time", "wall_time"))
        found.update(_poses(state, ""))
    return found


def _poses(parent: sdf.Element, prefix: str) -> Iterator[Tuple[str, Tuple[Pose3D, sdf.Element]]]:
    for element in parent.iterchildren("model", "link"):
        sdf.check_children(element, ("link", "model", "pose", "scale"), ("acceleration", "collision", "velocity",
                                                                         "wrench"))
        scale = sdf.only(element, "scale")
        if scale is not None and sdf.numbers(scale, 3) != (1.0, 1.0, 1.0):
            raise sdf.error(scale, f"<scale> is '{sdf.text_of(scale)}', supported: 1 1 1")
        name = prefix + sdf.name_of(element)
        if sdf.only(element, "pose") is not None:
            yield name, (sdf.pose_of(element), element)
        yield from _poses(element, name + "/")
