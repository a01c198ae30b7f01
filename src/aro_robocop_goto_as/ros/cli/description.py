"""Prints the URDF of the model that parameter files choose, for launch files that were given no model."""

import os
import sys
from typing import Any, Dict, List, Optional

import yaml

from ...errors import ParameterError, RobocopError, RobotModelError
from ...robot.model_names import DEFAULT_MODEL, urdf_of

MODEL_VARIABLE = "TURTLEBOT3_MODEL"  # the model where no file chooses one, as in the launch file


def merged(paths: List[str]) -> Dict[str, Any]:
    """The keys of several YAML files, the later file wins; ParameterError names the file that can't be read."""
    values: Dict[str, Any] = {}
    for path in paths:
        try:
            with open(path, encoding="utf-8") as stream:
                raw = yaml.safe_load(stream) or {}
        except (OSError, UnicodeDecodeError, yaml.YAMLError) as error:
            raise ParameterError(f"{path}: {error}") from error
        if not isinstance(raw, dict):
            raise ParameterError(f"{path}: expected lines of 'KEY: VALUE'")
        values.update(raw)
    return values


def _urdf(chosen: Any, package: str) -> str:
    """Path of the chosen model's URDF, or else of the environment's; RobotModelError says if it is the latter's."""
    of_environment = os.environ.get(MODEL_VARIABLE)
    if chosen is not None or not of_environment:
        return urdf_of(DEFAULT_MODEL if chosen is None else str(chosen), package)
    try:
        return urdf_of(of_environment, package)
    except RobotModelError as error:
        raise RobotModelError(f"{error}; the environment variable {MODEL_VARIABLE} chose it") from error


def main(arguments: Optional[List[str]] = None) -> None:
    """Print the URDF. Arguments: the package's folder, the launch argument `robots`, parameter files; '' for none."""
    package, robots, *paths = sys.argv[1:] if arguments is None else arguments
    try:
        values = merged([path for path in paths if path])
        if values.get("robots") and not robots:
            print(
                "robocop_sim.launch: parameter `robots` is set in a file, which gives the simulator these robots but "
                "does not start their other nodes; pass it as the argument robots:=... instead",
                file=sys.stderr,
            )
        with open(_urdf(values.get("model"), package), encoding="utf-8") as urdf:
            print(urdf.read(), end="")
    except RobocopError as error:
        sys.exit(f"{error.code}: {error}")
