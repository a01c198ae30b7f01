"""Prints the URDF of the model that launch arguments or parameter files choose; refuses unknown models, with a list."""

import os
import sys
from typing import Any, Dict

import yaml

from ...errors import RobotModelError
from ...robot.model_names import DEFAULT_MODEL, urdf_of

MODEL_VARIABLE = "TURTLEBOT3_MODEL"  # the model where no file chooses one, as in the launch file


class _Loader(yaml.SafeLoader):
    """Reads values with a tag, such as rosparam's !degrees, as None: the model's name has none."""


_Loader.add_multi_constructor("!", lambda loader, suffix, node: None)


def main() -> None:
    """Print the URDF. Arguments: the package's folder, `model`, `robots`, parameter files; '' for none.

    roslaunch calls it. Exit status 1, with the reason, for values that the simulator would refuse later.
    """
    package, model, robots, *paths = sys.argv[1:]
    values: Dict[str, Any] = {}
    for path in filter(None, paths):
        with open(path, encoding="utf-8") as stream:  # roslaunch has loaded these files, and refuses those with errors
            values.update(yaml.load(stream, _Loader) or {})
    if values.get("robots") and not robots:
        print(
            "robocop_sim.launch: parameter `robots` is set in a file, which gives the simulator these robots but "
            "does not start their other nodes; pass it as the argument robots:=... instead",
            file=sys.stderr,
        )
    chosen = model or values.get("model")
    try:
        urdf = urdf_of(str((os.environ.get(MODEL_VARIABLE) or DEFAULT_MODEL) if chosen is None else chosen), package)
        for robot in filter(None, (part.strip() for part in robots.split(";"))):  # as in launch/each_robot.launch
            chosen = robot.split()[0].partition(":")[2]
            urdf_of(chosen or DEFAULT_MODEL, package)
    except RobotModelError as error:
        note = f"; the environment variable {MODEL_VARIABLE} chose it" if chosen is None else ""
        sys.exit(f"{error.code}: {error}{note}")
    with open(urdf, encoding="utf-8") as text:
        print(text.read(), end="")
