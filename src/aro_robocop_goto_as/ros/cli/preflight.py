"""What is refused of a launch file's arguments before anything is started, as NAME:=VALUE on the command line."""

import datetime
import os
from pathlib import Path
from typing import Any, Mapping

import rosparam  # with its tags for YAML, such as !degrees

from ...errors import ParameterError
from ...geometry import Pose2D
from ...param_loading import declared, from_dict
from ...reading import reading
from ...robot.model_names import urdf_of
from ...sim_params import SimParams
from ...suggestions import did_you_mean
from ...world.load import RANDOM, find_world
from ...world.spawn_texts import parse_count, parse_robots, parse_spawn
from ..share import share


def check(given: Mapping[str, str]) -> None:
    """RobocopError for texts that the simulator would refuse, and for files that the parameter server can't have.

    A world is found, but not read. roslaunch checks numbers, and the simulator what its parameter files say.
    """
    are_texts = {name for name, spec in declared(SimParams).items() if isinstance(spec.default, str)}
    texts = {name: text for name, text in given.items() if text and name in are_texts}
    p = from_dict(SimParams, texts, "launch arguments")
    if p.world.world != RANDOM:
        find_world(p.world.world, os.path.join(share(), "worlds"))
    urdf_of(p.robots.model, share())
    if given.get("profile"):
        _require_profile(given["profile"])
    parse_spawn(p.robots.spawn, Pose2D())
    text = p.robots.robots.strip()
    if text.isdecimal():
        parse_count(text)
    elif text:
        for request in parse_robots(text):
            urdf_of(request.model or p.robots.model, share())
    for name, value in given.items():
        if name.endswith("config") and value.endswith(".yaml") and os.path.isfile(value):
            with reading(value, ParameterError, "parameters in YAML"):
                require_parameters(rosparam.yaml.safe_load(Path(value).read_text(encoding="utf-8")) or {}, value)


def _require_profile(name: str) -> None:
    known = sorted(path.stem for path in Path(share(), "config", "profiles").glob("*.yaml"))
    if name not in known:
        hint = did_you_mean(name, known)
        raise ParameterError(f"profile: there is no profile {name!r}; known are: {', '.join(known)}{hint}")


def require_parameters(value: Any, where: str) -> None:
    """ParameterError, naming the key, for what the parameter server can't have: no value, a date, a large integer.

    roslaunch prints a traceback of its XML-RPC library.
    """
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
