"""World + a model put in, taken out or moved -> World."""

import os
from dataclasses import replace
from typing import Tuple

from . import sdf
from .errors import WorldError
from .geometry import Pose2D, Pose3D, compose, compose3, inverse3
from .resources import locate_model
from .sdf_world import read_model
from .shapes import Obstacle, World

LEVEL = 1e-9
# Obstacles are named MODEL/LINK/COLLISION here and MODEL::LINK in Gazebo.
PLAIN_NAME = "printable characters without '/', '::', and spaces at the ends"


def requested_model(name: str, xml: str, file: str, pose: Pose3D) -> World:
    """A world of nothing but the model that a request describes, at a pose in the world; by its own name where `name`
    is empty.

    xml: the text of its SDF, or empty; file: what an <include> may have as its <uri>, or empty. Relative paths start
    at the directory that this process runs in. WorldError unless one of both is given, where it can't be read, and
    where its name could not be told from the names of what is in models.
    """
    if bool(xml) == bool(file):
        raise WorldError("expected either xml or file")
    if name and not _is_plain(name):
        raise WorldError(f"the name {name!r} of the request: expected {PLAIN_NAME}")
    root = sdf.parse_text(xml.encode(), "xml of the request") if xml else sdf.parse(_located(file))
    model = read_model(root, name, pose)
    (own_name,) = model.models
    if not _is_plain(own_name):
        raise WorldError(f"the name {own_name!r} of the model in {model.path}: expected {PLAIN_NAME}; the request may "
                         "give another name")
    return model


def _is_plain(name: str) -> bool:
    return bool(name) and name == name.strip() and name.isprintable() and "/" not in name and "::" not in name


def _located(file: str) -> str:
    try:
        return locate_model(file, os.getcwd(), "where the simulator runs")
    except WorldError as exc:
        raise WorldError(f"file of the request: {exc}") from exc


def with_model(world: World, model: World) -> World:
    """A world with what another one holds put in; WorldError where a model's name is taken."""
    taken = sorted(set(model.models) & set(world.models))
    if taken:
        raise WorldError(f"there is a model '{taken[0]}' already; expected another name")
    return replace(world, obstacles=world.obstacles + model.obstacles, models={**world.models, **model.models})


def without_model(world: World, name: str) -> World:
    """A world with a model taken out; WorldError if there is none of that name."""
    _check_known(world, name)
    models = {other: pose for other, pose in world.models.items() if other != name}
    return replace(world, obstacles=tuple(o for o in world.obstacles if not _belongs(o, name)), models=models)


def with_model_at(world: World, name: str, pose: Pose3D) -> World:
    """A world with a model at another pose in the world; WorldError if there is none, or it moves and would lean."""
    _check_known(world, name)
    shift = compose3(pose, inverse3(world.models[name]))
    obstacles = tuple(_shifted(o, shift) if _belongs(o, name) else o for o in world.obstacles)
    return replace(world, obstacles=obstacles, models={**world.models, name: pose})


def _check_known(world: World, name: str) -> None:
    if name not in world.models:
        raise WorldError(f"there is no model '{name}'; there are: {', '.join(world.models) or 'none'}")


def _belongs(obstacle: Obstacle, model: str) -> bool:
    return obstacle.name.startswith(model + "/")


def _shifted(obstacle: Obstacle, shift: Pose3D) -> Obstacle:
    moved = replace(obstacle, pose=compose3(shift, obstacle.pose))
    if obstacle.motion is None:
        return moved
    flat, leaning = _on_plane(shift)
    if leaning:
        raise WorldError(f"'{obstacle.name}' moves by script; expected a level pose")
    start = compose(flat, obstacle.motion.world_from_model)
    return replace(moved, motion=replace(obstacle.motion, world_from_model=start))


def _on_plane(pose: Pose3D) -> Tuple[Pose2D, bool]:
    """A pose seen from above, and whether it leans."""
    qx, qy, _, _ = pose.orientation
    return pose.on_plane(), abs(qx) + abs(qy) > LEVEL
