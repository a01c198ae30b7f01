"""What simulator and parameter server would refuse of parameters, found before anything is started."""

import datetime
import os
from typing import Any, Dict

from ...errors import ParameterError
from ...geometry import Pose2D
from ...param_loading import from_dict
from ...robot.model_names import urdf_of
from ...sim_params import SimParams
from ...world.load import RANDOM, find_world
from ...world.spawn_texts import parse_count, parse_robots, parse_spawn
from ..share import share


def check(given: Dict[str, Any], node: str) -> None:
    """RobocopError for parameters of a simulator with this name that it would refuse; files are found, but not read."""
    p = from_dict(SimParams, given, f"parameters of {node}")
    if p.world.world != RANDOM:
        find_world(p.world.world, os.path.join(share(), "worlds"))
    urdf_of(p.robots.model, share())
    parse_spawn(p.robots.spawn, Pose2D())
    text = p.robots.robots.strip()
    if text.isdecimal():
        parse_count(text)
    elif text:
        for request in parse_robots(text):
            urdf_of(request.model or p.robots.model, share())


def require_parameters(value: Any, where: str) -> None:
    """ParameterError, naming the key, for what the parameter server can't have: no value, a date, a large integer."""
    if isinstance(value, dict):
        for key, entry in value.items():
            if not isinstance(key, str):
                raise ParameterError(f"{where}: {key!r} is no name; put it in quotes if it is meant to be one")
            require_parameters(entry, f"{where}: {key}")
    elif isinstance(value, list):
        for entry in value:
            require_parameters(entry, where)
    elif value is None:
        raise ParameterError(f"{where} has no value; remove the line for the default")
    elif isinstance(value, int) and not -(2**31) <= value < 2**31:
        raise ParameterError(f"{where}: {value} is too large for an integer of ROS; as a number write {float(value):g}")
    elif isinstance(value, (datetime.date, set, tuple)):
        raise ParameterError(f"{where}: {value} is no number, text or list; put it in quotes if it is a text")
