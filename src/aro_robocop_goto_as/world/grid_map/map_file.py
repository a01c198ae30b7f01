"""Read the YAML file of a map_server map."""

import contextlib
import ntpath
import os
from dataclasses import MISSING, dataclass, replace
from typing import Any, List, Tuple

import yaml

from ...errors import ParameterError, WorldError
from ...geometry import MAX_COORDINATE
from ...param_loading import declared, from_dict, parameter, positive, several

SUPPORTED = "PGM, PNG or BMP"  # formats of a map's image
MODES = ("trinary", "scale", "raw")


@dataclass(frozen=True)
class MapSpec:
    """The keys of the file, as on wiki.ros.org/map_server; origin: x, y [m], yaw [rad] of the lower left corner."""

    image: str = parameter()  # a path
    resolution: float = positive(high=1e3)  # [m] of a cell
    origin: Tuple[float, ...] = several(3, -MAX_COORDINATE, MAX_COORDINATE, default=MISSING)
    negate: bool = parameter()
    occupied_thresh: float = parameter(low=0.0, high=1.0)
    free_thresh: float = parameter(low=0.0, high=1.0)
    mode: str = parameter("trinary", choices=MODES)

    def conflicts(self) -> List[str]:
        """What is wrong between the thresholds, in words."""
        if self.free_thresh <= self.occupied_thresh:
            return []
        return [f"free_thresh: expected at most occupied_thresh, {self.occupied_thresh:g}, got {self.free_thresh:g}"]


def read_spec(path: str) -> Tuple[MapSpec, List[str], List[str]]:
    """Read a map's YAML file: the map, its keys that are not used here, and what differs from what the file says.

    WorldError names file, key, the value found and what was expected.
    """
    with open(path, encoding="utf-8", errors="replace") as file:  # comments may be in another encoding
        raw = yaml.safe_load(file)
    if not isinstance(raw, dict):
        raise WorldError(f"{path}: not a map: expected the keys {', '.join(declared(MapSpec))}")
    known = {key: _as_map_server(key, value) for key, value in raw.items() if key in declared(MapSpec)}
    try:
        spec = from_dict(MapSpec, known, path)
    except ParameterError as error:
        raise WorldError(str(error)) from error
    image, different = _image(path, spec.image)
    return replace(spec, image=image), [str(key) for key in raw if key not in known], different


def _as_map_server(key: str, value: Any) -> Any:
    """A value as map_server takes it: 0 and 1 are booleans, and 5e-2 is a number, which YAML 1.1 calls a text."""
    if isinstance(value, list):
        return [_as_map_server(key, it) for it in value]
    if key == "negate" and value in (0, 1):
        return bool(value)
    with contextlib.suppress(ValueError):
        return float(value) if isinstance(value, str) and key not in ("image", "mode") else value
    return value


def _image(path: str, given: str) -> Tuple[str, List[str]]:
    """The path of the image, and what is to be said of it: a path that is not here means the file of that name here."""
    folder, name = os.path.dirname(path), ntpath.basename(given)  # which knows both machines' separators
    image, beside = os.path.join(folder, given), os.path.join(folder, name)
    if os.path.isfile(image):
        return image, []
    if os.path.isfile(beside):
        return beside, [f"there is no image {given}; {name} beside the map's file is used"]
    raise WorldError(f"{path}: image: expected a {SUPPORTED} file, but there is no file {image}")
