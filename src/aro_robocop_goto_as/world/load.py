"""Find a world file by its name or path and load it, whatever its format."""

import os
import re

from ..errors import WorldError
from ..reading import reading
from ..suggestions import did_you_mean
from .grid_map.reader import read_map
from .ground import levelled
from .model import World
from .sdf.reader import read_world

RANDOM = "random"  # in place of a name: the world that is made from the seed
_MAP_EXTENSIONS = (".yaml", ".yml")
_EXTENSIONS = (".sdf", ".world", *_MAP_EXTENSIONS)

_XML = re.compile(
    rb"(\xef\xbb\xbf)?\s*<|\xff\xfe|\xfe\xff"
)  # how it begins, with the byte order marks of UTF-8 and UTF-16

LAB_WORLDS = ("house", "aro_maze_1", "aro_maze_2", "aro_maze_8")  # names that the original lab's launch file accepted
LAB_WORLD_HINT = ", which the original lab had and this package does not have: give the path of its file"


def find_world(name_or_path: str, directory: str) -> str:
    """The path of a world: DIRECTORY/NAME.sdf for a bare name, else the path itself.

    A bare name has no slash and no extension of a world file. WorldError if the file does not exist.
    """
    is_name = os.path.basename(name_or_path) == name_or_path and not name_or_path.endswith(_EXTENSIONS)
    path = os.path.join(directory, name_or_path + ".sdf") if is_name else name_or_path
    if os.path.isfile(path):
        return path
    entries = os.listdir(directory) if os.path.isdir(directory) else []
    known = sorted(entry[: -len(".sdf")] for entry in entries if entry.endswith(".sdf"))
    hint = LAB_WORLD_HINT if name_or_path in LAB_WORLDS else ""
    if not is_name and not os.path.isabs(path):
        hint = f", looked for in {os.getcwd()}, where roslaunch starts its nodes; give an absolute path"
    raise WorldError(
        f"there is no world '{name_or_path}'{hint} (no file {os.path.abspath(path)}); "
        f"worlds in {directory}: {', '.join(known) or 'none'}{did_you_mean(name_or_path, known)}"
    )


def load_world(path: str) -> World:
    """The world in an SDF file (1.4 and later, a <world> or a single <model>) or in the YAML file of a map_server map.

    The ground on which robots stand is at z = 0, see levelled.

    WorldError names the file, the line where there is one, what is wrong and what is supported.
    """
    with reading(path, WorldError, "an SDF file, or the YAML file of a map"):
        if path.endswith(_MAP_EXTENSIONS):
            return read_map(path)
        with open(path, "rb") as file:
            if not _XML.match(file.read()):  # an image of a map, a world of Stage or Webots, ...
                raise WorldError(
                    f"{path}:1: not XML; expected an SDF file, or the YAML file of a map, whose image may be the "
                    "floor plan of a world of Stage"
                )
        return levelled(read_world(path))
