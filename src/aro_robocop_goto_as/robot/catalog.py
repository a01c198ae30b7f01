"""Name of a model -> RobotModel: its body from urdf/NAME.urdf, its figures from config/models/NAME.yaml."""

import os

import yaml

from ..errors import RobotModelError
from ..param_loading import from_dict
from .model import RobotModel, load_robot
from .model_figures import ModelFigures


def load_model(name: str, package: str) -> RobotModel:
    """A model by its name, from this package's folder.

    RobotModelError names the known models, or the file and what is wrong in it; ParameterError names the figure.
    """
    return load_robot(urdf_of(name, package), load_figures(os.path.join(package, "config", "models", name + ".yaml")))


def urdf_of(name: str, package: str) -> str:
    """Path of a model's URDF; RobotModelError names the known models."""
    path = os.path.join(package, "urdf", name + ".urdf")
    if os.path.basename(name) != name or not os.path.isfile(path):
        known = sorted(entry[: -len(".urdf")] for entry in os.listdir(os.path.join(package, "urdf")))
        raise RobotModelError(f"there is no model {name!r}; known are: {', '.join(known)}")
    return path


def load_figures(path: str) -> ModelFigures:
    """The figures in a YAML file; RobotModelError if it can't be read, ParameterError if a figure is wrong."""
    try:
        with open(path, encoding="utf-8") as stream:
            raw = yaml.safe_load(stream)
    except (OSError, yaml.YAMLError) as error:
        raise RobotModelError(f"{path}: {error}") from error
    if not isinstance(raw, dict):
        raise RobotModelError(f"{path}: expected lines of 'NAME: VALUE'")
    return from_dict(ModelFigures, raw, path)
