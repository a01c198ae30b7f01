"""The models, by the names of their files; imports nothing, because launch files ask before anything starts."""

import os

from ..errors import RobotModelError
from ..suggestions import did_you_mean

DEFAULT_MODEL = "burger"


def urdf_of(name: str, package: str) -> str:
    """Path of a model's URDF; RobotModelError names the known models."""
    path = os.path.join(package, "urdf", name + ".urdf")
    if os.path.basename(name) != name or not os.path.isfile(path):
        known = sorted(entry[: -len(".urdf")] for entry in os.listdir(os.path.join(package, "urdf")))
        hint = did_you_mean(name, known)
        raise RobotModelError(f"there is no model {name!r}; known are: {', '.join(known)}{hint}")
    return path
