"""Read a map_server map, its YAML file and its image, into occupancy cells."""

import math
import os
from dataclasses import dataclass
from typing import Any, Dict, Tuple

import numpy as np
import yaml

from ...errors import WorldError
from ...geometry import Pose2D, wrap_angle
from .image import read_image

MODES = ("trinary", "scale", "raw")
MAX_QUOTED = 10  # items of a list that an error message quotes
_REQUIRED = ("image", "resolution", "origin", "negate", "occupied_thresh", "free_thresh")
_BOOLEANS = {"0": False, "false": False, "1": True, "true": True}


@dataclass(frozen=True)
class MapSpec:
    """The entries of the YAML file, named as on wiki.ros.org/map_server; image: a path; unknown: keys not used here."""

    image: str
    resolution: float
    origin: Pose2D
    negate: bool
    occupied_thresh: float
    free_thresh: float
    mode: str
    unknown: Tuple[str, ...]


class _Entries:
    """The keys of a YAML mapping with their nodes, so that an error can name the line."""

    def __init__(self, path: str) -> None:
        self.path = path
        try:
            with open(path, encoding="utf-8") as file:
                root = yaml.compose(file, yaml.SafeLoader)
        except OSError as exc:
            raise WorldError(f"{path}: can't read the file: {exc.strerror or exc}") from exc
        except UnicodeDecodeError as exc:
            raise WorldError(f"{path}: not UTF-8 text: {exc.reason}") from exc
        except yaml.YAMLError as exc:
            mark = getattr(exc, "problem_mark", None)
            line = f":{mark.line + 1}" if mark else ""
            raise WorldError(f"{path}{line}: not YAML: {getattr(exc, 'problem', None) or exc}") from exc
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
        found = repr(node.value) if isinstance(node, yaml.ScalarNode) else f"a {node.id}"
        if isinstance(node, yaml.SequenceNode) and len(node.value) <= MAX_QUOTED:
            found = f"[{', '.join(i.value if isinstance(i, yaml.ScalarNode) else f'a {i.id}' for i in node.value)}]"
        return WorldError(f"{self.path}:{node.start_mark.line + 1}: {key} is {found}, expected {expected}")

    def text(self, key: str, expected: str) -> str:
        """A key's scalar value; WorldError if it is empty, a list or a mapping."""
        node = self.nodes[key]
        if not isinstance(node, yaml.ScalarNode) or not node.value:
            raise self.error(key, expected)
        return str(node.value)

    def number(self, key: str, low: float, high: float, expected: str) -> float:
        """A key's number; WorldError if it is not one or out of bounds."""
        value = _number(self.text(key, expected))
        if not low <= value <= high:
            raise self.error(key, expected)
        return value

    def numbers(self, key: str, count: int, expected: str) -> Tuple[float, ...]:
        """A key's list of `count` finite numbers; WorldError if it is anything else."""
        node = self.nodes[key]
        items = node.value if isinstance(node, yaml.SequenceNode) else []
        values = tuple(_number(item.value) for item in items if isinstance(item, yaml.ScalarNode))
        if len(values) != count or len(items) != count or not all(math.isfinite(value) for value in values):
            raise self.error(key, expected)
        return values


def _number(text: str) -> float:
    try:
        return float(text)
    except ValueError:
        return math.nan


def read_spec(path: str) -> MapSpec:
    """Read a map's YAML file; WorldError names file, line, key, the value found and what was expected."""
    entries = _Entries(path)
    resolution = entries.number("resolution", 1e-6, 1e3, "metres per cell, greater than 0")
    x, y, yaw = entries.numbers("origin", 3, "three numbers [x, y, yaw] of the lower left corner [m, m, rad]")
    negate = entries.text("negate", "0 or 1").lower()
    if negate not in _BOOLEANS:
        raise entries.error("negate", "0 or 1")
    occupied = entries.number("occupied_thresh", 0.0, 1.0, "a number from 0 to 1")
    free = entries.number("free_thresh", 0.0, occupied, f"a number from 0 to occupied_thresh, which is {occupied:g}")
    mode = entries.text("mode", " or ".join(MODES)) if "mode" in entries.nodes else MODES[0]
    if mode not in MODES:
        raise entries.error("mode", " or ".join(MODES))
    image = os.path.join(os.path.dirname(path), entries.text("image", "the name of a PGM or PNG file"))
    if not os.path.isfile(image):
        raise entries.error("image", f"a PGM or PNG file, but there is no file {image}")
    unknown = tuple(key for key in entries.nodes if key not in (*_REQUIRED, "mode"))
    return MapSpec(image, resolution, Pose2D(x, y, wrap_angle(yaw)), _BOOLEANS[negate], occupied, free, mode, unknown)


def read_cells(spec: MapSpec) -> np.ndarray:
    """A map's image as the cells that map_server would publish: (rows, columns) int8, the image's last row first.

    -1 unknown, 0 free to 100 occupied; in mode raw whatever the image holds. WorldError as read_image.
    """
    pixels = read_image(spec.image)
    if pixels.shape[-1] == 1:  # the usual map: look the 256 greys up in a table
        cells = _cells(np.arange(256, dtype=np.uint8)[:, None], spec)[pixels[..., 0]]
    else:
        cells = _cells(pixels, spec)
    return np.ascontiguousarray(cells[::-1])


def _cells(pixels: np.ndarray, spec: MapSpec) -> np.ndarray:
    """Cell values (...) int8 of pixels (..., channels) uint8, with the arithmetic of map_server's image_loader.

    In mode trinary all channels are averaged, alpha included. Else the last of several is left out, and where it is 0
    no shade between the thresholds is known: it is treated as alpha, even in an image without alpha.
    """
    shaded = spec.mode != "trinary" and pixels.shape[-1] > 1
    greys = (pixels[..., :-1] if shaded else pixels).mean(axis=-1)
    if spec.negate:
        greys = 255.0 - greys
    if spec.mode == "raw":
        return greys.astype(np.uint8).view(np.int8)  # values above 127 become negative
    occupied = (255.0 - greys) / 255.0
    between = np.full(greys.shape, -1.0)
    if spec.mode == "scale":
        span = max(spec.occupied_thresh - spec.free_thresh, 1e-9)
        between = np.floor(99.0 * ((occupied - spec.free_thresh) / span))
        if shaded:
            between[pixels[..., -1] == 0] = -1.0
    cells = np.where(occupied > spec.occupied_thresh, 100.0, np.where(occupied < spec.free_thresh, 0.0, between))
    return cells.astype(np.int8)
