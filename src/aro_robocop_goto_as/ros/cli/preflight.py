"""Refuses impossible arguments of a launch file, NAME:=VALUE on the command line, before anything is started."""

import datetime
import os
from pathlib import Path
from typing import Any, Mapping, Type, TypeVar

import rosparam  # with its tags for YAML, such as !degrees

from ...errors import ParameterError
from ...geometry import Pose2D
from ...launch_arguments import TRUE
from ...param_loading import declared, from_texts
from ...reading import reading
from ...robot.model_names import urdf_of
from ...simulation.params import SimParams
from ...suggestions import did_you_mean
from ...web.params import WebParams
from ...world.load import RANDOM, find_world
from ...world.spawn_texts import parse_count, parse_robots, parse_spawn
from ..share import share

T = TypeVar("T")


def _params(given: Mapping[str, str], cls: Type[T]) -> T:
    """Those of the arguments that are parameters of a dataclass."""
    known = declared(cls)
    return from_texts(cls, {name: text for name, text in given.items() if name in known}, "launch arguments")


def check(given: Mapping[str, str]) -> None:
    """RobocopError for values that the simulator would refuse, and for files that the parameter server can't store.

    A world is found, but not read. The simulator checks what its parameter files say.
    """
    p = _params(given, SimParams)
    if p.world.world != RANDOM:
        find_world(p.world.world, os.path.join(share(), "worlds"))
    urdf_of(p.robots.model, share())
    if given.get("profile"):
        _require_profile(given["profile"])
    parse_spawn(p.robots.spawn or " ".join(given.get(name) or "0" for name in ("x_pos", "y_pos", "yaw")), Pose2D())
    text = p.robots.robots.strip()
    if text.isdecimal():
        parse_count(text)
    elif text:
        for request in parse_robots(text):
            urdf_of(request.model or p.robots.model, share())
    if given.get("web") in TRUE:
        _params(given, WebParams)
    for name, value in given.items():
        if name.endswith("config") and value.endswith(".yaml") and "$(" not in value:
            if not os.path.isfile(value):
                raise ParameterError(f"{name}: there is no file {os.path.abspath(value)}")
            with reading(value, ParameterError, "parameters in YAML"):
                require_parameters(rosparam.yaml.safe_load(Path(value).read_text(encoding="utf-8")) or {}, value)


def _require_profile(name: str) -> None:
    known = sorted(path.stem for path in Path(share(), "config", "profiles").glob("*.yaml"))
    if name not in known:
        hint = did_you_mean(name, known)
        raise ParameterError(f"profile: there is no profile {name!r}; known are: {', '.join(known)}{hint}")


def require_parameters(value: Any, where: str) -> None:
    """ParameterError, naming the key, for values that the parameter server can't store: none, a date, a large integer.

    For such a value, roslaunch only prints a traceback of its XML-RPC library.
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
