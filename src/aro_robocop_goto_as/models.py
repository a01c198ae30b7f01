"""Name of a model -> RobotModel: urdf/NAME.urdf is its body, config/models/NAME.yaml what its drive allows."""

import os

import yaml

from .errors import RobotModelError
from .params import ModelFigures, from_dict
from .robot import RobotModel, load_robot


def load_model(name: str, package: str) -> RobotModel:
    """A model by its name, of this package's folder.

    RobotModelError names the models that there are, or what is wrong in which file; ParameterError which figure.
    """
    urdf = os.path.join(package, "urdf", name + ".urdf")
    if os.path.basename(name) != name or not os.path.isfile(urdf):
        known = sorted(entry[: -len(".urdf")] for entry in os.listdir(os.path.join(package, "urdf")))
        raise RobotModelError(f"there is no model {name!r}; known are: {', '.join(known)}")
    return load_robot(urdf, load_figures(os.path.join(package, "config", "models", name + ".yaml")))


def load_figures(path: str) -> ModelFigures:
    """The figures in a YAML file; RobotModelError where it can't be read, ParameterError for what it says."""
    try:
        with open(path, encoding="utf-8") as stream:
            raw = yaml.safe_load(stream)
    except (OSError, yaml.YAMLError) as error:
        raise RobotModelError(f"{path}: {error}") from error
    if not isinstance(raw, dict):
        raise RobotModelError(f"{path}: expected lines of 'NAME: VALUE'")
    return from_dict(ModelFigures, raw, path)
