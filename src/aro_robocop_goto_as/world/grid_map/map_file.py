"""Read the YAML file of a map_server map."""

import ntpath
import os
from dataclasses import dataclass
from typing import Any, Dict, Tuple

import yaml

from ...errors import WorldError
from ...geometry import MAX_COORDINATE, Pose2D, wrap_angle
from ...reading import finite_numbers

SUPPORTED = "PGM, PNG or BMP"  # formats of a map's image
MODES = ("trinary", "scale", "raw")
MAX_QUOTED = 60  # characters of a list that an error message quotes
_REQUIRED = ("image", "resolution", "origin", "negate", "occupied_thresh", "free_thresh")
_BOOLEANS = {"0": False, "false": False, "1": True, "true": True}


@dataclass(frozen=True)
class MapSpec:
    """The entries of the YAML file, named as on wiki.ros.org/map_server; image: a path; unknown: keys not used here.

    image_beside: what is to be said of an image that lies beside the file instead of where the file says, or empty
    """

    image: str
    resolution: float
    origin: Pose2D
    negate: bool
    occupied_thresh: float
    free_thresh: float
    mode: str
    unknown: Tuple[str, ...]
    image_beside: str


class _Entries:
    """The keys of a YAML mapping with their nodes, so that an error can name the line."""

    def __init__(self, path: str) -> None:
        self.path = path
        with open(path, encoding="utf-8", errors="replace") as file:  # comments may be in another encoding
            self.content = file.read()
        root = yaml.compose(self.content, yaml.SafeLoader)
        if not isinstance(root, yaml.MappingNode):
            raise WorldError(f"{path}:1: not a map: expected the keys {', '.join(_REQUIRED)}")
        self.nodes: Dict[str, Any] = {str(key.value): value for key, value in root.value}
        missing = [key for key in _REQUIRED if key not in self.nodes]
        if missing:
            raise WorldError(
                f"{path}: no {', '.join(missing)}; expected the keys {', '.join(_REQUIRED)} and optionally mode"
            )

    def error(self, key: str, expected: str) -> WorldError:
        """The error for a key's value: file, line, key, the value found, what was expected."""
        node = self.nodes[key]
        found = self.content[node.start_mark.index : node.end_mark.index]
        if isinstance(node, yaml.ScalarNode):
            found = repr(node.value)
        elif len(found) > MAX_QUOTED:
            found = f"a {node.id}"
        return WorldError(f"{self.path}:{node.start_mark.line + 1}: {key} is {found}, expected {expected}")

    def text(self, key: str, expected: str) -> str:
        """A key's scalar value; WorldError if it is empty, a list or a mapping."""
        node = self.nodes[key]
        if not isinstance(node, yaml.ScalarNode) or not node.value:
            raise self.error(key, expected)
        return str(node.value)

    def numbers(self, key: str, count: int, expected: str) -> Tuple[float, ...]:
        """A key's number, or the numbers of its list; WorldError if they are not finite, or not `count`."""
        node = self.nodes[key]
        nodes = [node] if count == 1 else node.value if isinstance(node, yaml.SequenceNode) else []
        try:
            return finite_numbers(" ".join(str(node.value) for node in nodes), count)
        except ValueError as exc:
            raise self.error(key, expected) from exc

    def number(self, key: str, low: float, high: float, expected: str) -> float:
        """A key's number; WorldError if it is not one or out of bounds."""
        (value,) = self.numbers(key, 1, expected)
        if not low <= value <= high:
            raise self.error(key, expected)
        return value


def read_spec(path: str) -> MapSpec:
    """Read a map's YAML file; WorldError names file, line, key, the value found and what was expected."""
    entries = _Entries(path)
    resolution = entries.number("resolution", 1e-6, 1e3, "metres per cell, greater than 0")
    expected = "three numbers [x, y, yaw] of the lower left corner [m, m, rad]"
    x, y, yaw = entries.numbers("origin", 3, expected)
    if max(abs(x), abs(y)) > MAX_COORDINATE:
        raise entries.error("origin", f"{expected}, within +-{MAX_COORDINATE:g} m")
    negate = entries.text("negate", "0 or 1").lower()
    if negate not in _BOOLEANS:
        raise entries.error("negate", "0 or 1")
    occupied = entries.number("occupied_thresh", 0.0, 1.0, "a number from 0 to 1")
    free = entries.number("free_thresh", 0.0, occupied, f"a number from 0 to occupied_thresh, which is {occupied:g}")
    mode = entries.text("mode", " or ".join(MODES)) if "mode" in entries.nodes else MODES[0]
    if mode not in MODES:
        raise entries.error("mode", " or ".join(MODES))
    image, image_beside = _image(entries)
    unknown = tuple(key for key in entries.nodes if key not in (*_REQUIRED, "mode"))
    origin = Pose2D(x, y, wrap_angle(yaw))
    return MapSpec(image, resolution, origin, _BOOLEANS[negate], occupied, free, mode, unknown, image_beside)


def _image(entries: _Entries) -> Tuple[str, str]:
    """The path of the image, and what is to be said of it: a path that is not here means the file of that name here."""
    folder, given = os.path.dirname(entries.path), entries.text("image", f"the name of a {SUPPORTED} file")
    image, name = os.path.join(folder, given), ntpath.basename(given)  # which knows both machines' separators
    if os.path.isfile(image):
        return image, ""
    beside = os.path.join(folder, name)
    if os.path.isfile(beside):
        return beside, f"there is no image {given}; {name} beside the map's file is used"
    raise entries.error("image", f"a {SUPPORTED} file, but there is no file {image}")
