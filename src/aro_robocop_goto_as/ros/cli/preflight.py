"""What the simulator would refuse of its parameters, found before anything is started, and in the same words."""

import os
from typing import Any, Dict

from ...geometry import Pose2D
from ...param_loading import from_dict
from ...robot.model_names import urdf_of
from ...sim_params import SimParams
from ...world.load import RANDOM, find_world
from ...world.spawn import parse_count, parse_robots, parse_spawn
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
