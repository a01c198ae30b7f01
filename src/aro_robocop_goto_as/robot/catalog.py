"""Name of a model -> RobotModel: its body from urdf/NAME.urdf, its figures from config/models/NAME.yaml."""

import os

import yaml

from ..errors import RobotModelError
from ..param_loading import from_dict
from ..reading import reading
from .model import ModelFigures, RobotModel
from .model_names import urdf_of
from .urdf import load_robot


def load_model(name: str, package: str) -> RobotModel:
    """A model by its name, from this package's folder.

    RobotModelError names the known models, or the file and what is wrong in it; ParameterError names the figure.
    """
    return load_robot(urdf_of(name, package), load_figures(os.path.join(package, "config", "models", name + ".yaml")))


def load_figures(path: str) -> ModelFigures:
    """The figures in a YAML file; RobotModelError if it can't be read, ParameterError if a figure is wrong."""
    expected = "lines of 'NAME: VALUE'"
    with reading(path, RobotModelError, expected):
        with open(path, encoding="utf-8") as stream:
            raw = yaml.safe_load(stream)
        if not isinstance(raw, dict):
            raise RobotModelError(f"{path}: expected {expected}")
        return from_dict(ModelFigures, raw, path)
