"""Name or path of a world -> World."""

import os

from .errors import WorldError
from .maps import read_map
from .sdf_world import read_world
from .shapes import Box, Cylinder, Geometry, Mesh, Obstacle, Plane, Sphere, Walls, World

__all__ = ["Box", "Cylinder", "Geometry", "Mesh", "Obstacle", "Plane", "Sphere", "Walls", "World", "find_world",
           "load_world"]
_MAPS = (".yaml", ".yml")
_ENDINGS = (".sdf", ".world", *_MAPS)

LAB_WORLDS = ("house", "aro_maze_1", "aro_maze_2", "aro_maze_8")  # names that the original lab's launch file took
NOT_HERE = ", which the original lab had and this package has not: give the path of its file"


def find_world(name_or_path: str, directory: str) -> str:
    """The path of a world: DIRECTORY/NAME.sdf for a bare name, else the path itself.

    A bare name has no slash and none of the endings of world files. WorldError if there is no such file.
    """
    bare = os.path.basename(name_or_path) == name_or_path and not name_or_path.endswith(_ENDINGS)
    path = os.path.join(directory, name_or_path + ".sdf") if bare else name_or_path
    if os.path.isfile(path):
        return path
    entries = os.listdir(directory) if os.path.isdir(directory) else []
    known = sorted(entry[: -len(".sdf")] for entry in entries if entry.endswith(".sdf"))
    hint = NOT_HERE if name_or_path in LAB_WORLDS else ""
    raise WorldError(
        f"there is no world '{name_or_path}'{hint} (no file {os.path.abspath(path)}); "
        f"worlds in {directory}: {', '.join(known) or 'none'}"
    )


def load_world(path: str) -> World:
    """The world that a file describes: SDF 1.4 to 1.7 of a <world> or a <model>, or a map_server map's YAML.

    Raises WorldError that names file, line, what is wrong there, and what is supported.
    """
    return read_map(path) if path.endswith(_MAPS) else read_world(path)
