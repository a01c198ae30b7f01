"""Insert, remove and move models of a world; every edit returns a new World, with its ground at z = 0."""

from dataclasses import replace

from ..errors import WorldError
from ..geometry import Pose3D, compose, compose3, inverse3
from ..reading import parse_xml, reading
from ..suggestions import unknown
from .ground import levelled
from .model import Obstacle, World
from .sdf.reader import read_model
from .sdf.uris import locate_model
from .sdf.xml import parse

# Obstacles are named MODEL/LINK/COLLISION here and MODEL::LINK in Gazebo, so neither separator may be part of a name.
VALID_NAME = "printable characters without '/' or '::', and without spaces at the ends"


def requested_model(name: str, xml: str, file: str, pose: Pose3D, world_path: str) -> World:
    """A world that contains only the model of an insertion request, at a pose in the world.

    name: the model's new name; empty: its own. Exactly one of xml, the text of an SDF, and file, a URI or path
    as in an <include> of the world's file at world_path, must be given. WorldError if it can't be read, or if the name
    could be confused with the names of obstacles.
    """
    if bool(xml) == bool(file):
        raise WorldError("expected either xml or file")
    with reading(f"{'xml' if xml else 'file'} of the request", WorldError, "a model in SDF"):
        root = parse_xml(xml.encode(), "xml of the request", WorldError) if xml else parse(_located(file, world_path))
        model = read_model(root, name, pose)
    (used,) = model.models
    if used != used.strip() or not used.isprintable() or "/" in used or "::" in used:
        owner, hint = ("request", "") if name else (f"model in {model.path}", "; the request may give another name")
        raise WorldError(f"the name {used!r} of the {owner}: expected {VALID_NAME}{hint}")
    return model


def _located(file: str, world_path: str) -> str:
    try:
        return locate_model(file, world_path)
    except WorldError as exc:
        raise WorldError(f"file of the request: {exc}") from exc


def with_model(world: World, model: World) -> World:
    """A world with the contents of another one added; WorldError if a model of the same name exists already."""
    duplicates = sorted(set(model.models) & set(world.models))
    if duplicates:
        raise WorldError(f"there is already a model '{duplicates[0]}'; expected another name")
    models = {**world.models, **model.models}
    return levelled(replace(world, obstacles=world.obstacles + model.obstacles, models=models))


def without_model(world: World, name: str) -> World:
    """A world with a model removed; WorldError if there is no model of that name."""
    _require_model(world, name)
    models = {other: pose for other, pose in world.models.items() if other != name}
    return levelled(replace(world, obstacles=tuple(o for o in world.obstacles if not _belongs(o, name)), models=models))


def with_model_at(world: World, name: str, pose: Pose3D) -> World:
    """A world with a model moved to another pose in the world.

    WorldError if there is no model of that name, or if it moves by script and the new pose is not level.
    """
    _require_model(world, name)
    shift = compose3(pose, inverse3(world.models[name]))
    obstacles = tuple(_shifted(o, shift) if _belongs(o, name) else o for o in world.obstacles)
    return levelled(replace(world, obstacles=obstacles, models={**world.models, name: pose}))


def _require_model(world: World, name: str) -> None:
    if name not in world.models:
        raise WorldError(unknown(f"there is no model '{name}'", name, world.models))


def _belongs(obstacle: Obstacle, model: str) -> bool:
    return obstacle.name.startswith(model + "/")


def _shifted(obstacle: Obstacle, shift: Pose3D) -> Obstacle:
    moved = replace(obstacle, pose=compose3(shift, obstacle.pose))
    if obstacle.motion is None:
        return moved
    if not shift.is_upright():
        raise WorldError(f"'{obstacle.name}' moves by script; expected a level pose")
    start = compose(shift.on_plane(), obstacle.motion.world_from_model)
    return replace(moved, motion=replace(obstacle.motion, world_from_model=start))
