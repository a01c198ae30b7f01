"""map_server's YAML and its image -> the cells of a grid map."""

import math
import os
from dataclasses import dataclass
from typing import Any, Dict, Tuple

import numpy as np
import yaml

from .errors import WorldError
from .geometry import Pose2D, wrap_angle

MODES = ("trinary", "scale", "raw")
MOST_TOLD = 10  # items of a list that an error repeats
PNG_MOST = 1032  # times that deflate makes something smaller, at most
_REQUIRED = ("image", "resolution", "origin", "negate", "occupied_thresh", "free_thresh")
_OPAQUE = np.array(True)  # of every pixel
_TRUTHS = {"0": False, "false": False, "1": True, "true": True}


@dataclass(frozen=True)
class MapSpec:
    """What the YAML file says; map_server's names, wiki.ros.org/map_server. image: a path; unknown: keys not used."""

    image: str
    resolution: float
    origin: Pose2D
    negate: bool
    occupied_thresh: float
    free_thresh: float
    mode: str
    unknown: Tuple[str, ...]


class _Entries:
    """The keys of a YAML mapping, each with its node, so that an error can tell the line."""

    def __init__(self, path: str) -> None:
        self.path = path
        try:
            with open(path, encoding="utf-8") as file:
                root = yaml.compose(file, yaml.SafeLoader)
        except OSError as exc:
            raise WorldError(f"{path}: can't read the file: {exc.strerror or exc}") from exc
        except UnicodeDecodeError as exc:
            raise WorldError(f"{path}: not a text in UTF-8: {exc.reason}") from exc
        except yaml.YAMLError as exc:
            mark = getattr(exc, "problem_mark", None)
            line = f":{mark.line + 1}" if mark else ""
            raise WorldError(f"{path}{line}: not YAML: {getattr(exc, 'problem', None) or exc}") from exc
        if not isinstance(root, yaml.MappingNode):
            raise WorldError(f"{path}:1: not a map: expected the keys {', '.join(_REQUIRED)}")
        self.nodes: Dict[str, Any] = {str(key.value): value for key, value in root.value}
        missing = [key for key in _REQUIRED if key not in self.nodes]
        if missing:
            raise WorldError(f"{path}: no {', '.join(missing)}; expected the keys {', '.join(_REQUIRED)}, and mode")

    def error(self, key: str, expected: str) -> WorldError:
        """What is expected of a key, with what is there and where."""
        node = self.nodes[key]
        found = repr(node.value) if isinstance(node, yaml.ScalarNode) else f"a {node.id}"
        if isinstance(node, yaml.SequenceNode) and len(node.value) <= MOST_TOLD:
            found = f"[{', '.join(i.value if isinstance(i, yaml.ScalarNode) else f'a {i.id}' for i in node.value)}]"
        return WorldError(f"{self.path}:{node.start_mark.line + 1}: {key} is {found}, expected {expected}")

    def text(self, key: str, expected: str) -> str:
        """A key's plain value."""
        node = self.nodes[key]
        if not isinstance(node, yaml.ScalarNode) or not node.value:
            raise self.error(key, expected)
        return str(node.value)

    def number(self, key: str, low: float, high: float, expected: str) -> float:
        """A key's number within bounds."""
        value = _number(self.text(key, expected))
        if not low <= value <= high:
            raise self.error(key, expected)
        return value

    def numbers(self, key: str, count: int, expected: str) -> Tuple[float, ...]:
        """A key's list of so many finite numbers."""
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
    """A map's YAML file. WorldError that names file, line, key, what is there and what is expected."""
    entries = _Entries(path)
    resolution = entries.number("resolution", 1e-6, 1e3, "metres a cell, greater than 0")
    x, y, yaw = entries.numbers("origin", 3, "three numbers [x, y, yaw] of the lower left corner [m, m, rad]")
    negate = entries.text("negate", "0 or 1").lower()
    if negate not in _TRUTHS:
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
    return MapSpec(image, resolution, Pose2D(x, y, wrap_angle(yaw)), _TRUTHS[negate], occupied, free, mode, unknown)


def read_cells(spec: MapSpec) -> np.ndarray:
    """A map's image as the cells that map_server publishes, (rows, columns) int8, the image's last row first.

    -1 unknown, 0 free to 100 occupied. WorldError if the image can't be read, and, before memory is taken for it, if
    its header claims more pixels than are in the file or than Pillow opens.
    """
    from PIL import Image  # here, as only maps need it

    try:
        with Image.open(spec.image) as image:
            if image.format not in ("PNG", "PPM"):
                raise WorldError(f"{spec.image}: a {image.format} image; supported: PGM, PNG")
            _check_held(image, spec.image)
            pixels, opaque = _grey(image, with_alpha=spec.mode == "trinary")
    except Image.DecompressionBombError as exc:
        raise WorldError(f"{spec.image}: the header claims too large an image ({exc}); expected no more than "
                         f"{2 * (Image.MAX_IMAGE_PIXELS or 0)} pixels") from exc
    except (OSError, SyntaxError, ValueError) as exc:
        raise WorldError(f"{spec.image}: not a PGM or PNG image that can be read: {exc}") from exc
    if pixels.dtype == np.uint8:  # the usual map: each of 256 greys is worked out once
        cells = _cells(np.arange(256.0), _OPAQUE, spec)[pixels]
    else:
        cells = _cells(pixels, opaque, spec)
    return np.ascontiguousarray(cells[::-1])


def _check_held(image: Any, path: str) -> None:
    """WorldError unless the file can hold as many pixels as its header claims.

    Pillow takes memory for all that are claimed, and looks for plain PGM's for minutes where there are none.
    """
    with open(path, "rb") as file:
        plain = file.read(2) == b"P2"
        blank = np.frombuffer(file.read() if plain else b"", dtype=np.uint8) <= ord(" ")
    if plain:
        most = int(np.count_nonzero(blank[:-1] & ~blank[1:])) - 3  # words, less width, height and maximum
    else:
        held = os.path.getsize(path) - image.tile[0][2]  # bytes from the pixels' start on
        bits = {"1": 1, "I": 16}.get(image.mode, 8)  # of a pixel, at least
        most = 8 * held * PNG_MOST if image.format == "PNG" else 8 * held // bits
    if image.width * image.height > most:
        raise WorldError(f"{path}: the header claims {image.width} x {image.height} pixels, expected no more than "
                         f"the {most} that the file can hold")


def _grey(image: Any, with_alpha: bool) -> Tuple[np.ndarray, np.ndarray]:
    """Greys from 0 to 255, the mean of a pixel's channels, and where it is opaque; bytes where there is one channel.

    As map_server has it, alpha is one of the channels in mode trinary.
    """
    if image.mode in ("1", "L"):
        return np.asarray(image.convert("L")), _OPAQUE
    if image.mode.startswith("I"):
        return np.asarray(image, dtype=np.float32) / np.float32(257.0), _OPAQUE  # 16 bits
    transparent = image.mode in ("LA", "PA", "RGBA") or "transparency" in image.info
    channels = np.asarray(image.convert("RGBA" if transparent else "RGB"), dtype=np.float32)
    opaque = channels[..., 3] == 255.0 if transparent else _OPAQUE
    return (channels if with_alpha else channels[..., :3]).mean(axis=-1), opaque


def _cells(greys: np.ndarray, opaque: np.ndarray, spec: MapSpec) -> np.ndarray:
    """Cell values (int8) of greys of any shape, by map_server's rules."""
    if spec.negate:
        greys = 255.0 - greys
    if spec.mode == "raw":
        return np.where(greys <= 100.0, greys, -1.0).astype(np.int8)
    occupied = (255.0 - greys) / 255.0
    between = np.full(np.shape(greys), -1.0)
    if spec.mode == "scale":
        span = max(spec.occupied_thresh - spec.free_thresh, 1e-9)
        between = np.where(opaque, np.floor(1.0 + 98.0 * (occupied - spec.free_thresh) / span), -1.0)
    cells = np.where(occupied > spec.occupied_thresh, 100.0, np.where(occupied < spec.free_thresh, 0.0, between))
    return cells.astype(np.int8)
