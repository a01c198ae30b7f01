"""Which robots are simulated, of which model and starting where, as the parameters request them."""

from typing import Callable, List

from ..raycast.free_places import free_place, free_places
from ..robot.model import RobotModel, RobotSpec
from ..sim_params import RobotParams
from ..world.model import World
from ..world.spawn import parse_count, parse_robots, parse_spawn


def robots_from(p: RobotParams, world: World, load: Callable[[str], RobotModel]) -> List[RobotSpec]:
    """The robots that the parameters `robots`, `model` and `spawn` request; `load` loads a model by its name.

    robots empty: one robot without a name at `spawn`, by default the world's own spawn; in a world without one, at the
    free place nearest to the origin. A number N: robot_1 to robot_N at free places around that pose. Else a list
    'NAME[:MODEL] X Y [YAW]; ...' [m, rad], of `model` where an entry names none. ParameterError says which parameter
    can't be honoured.
    """
    model = load(p.model)
    text = p.robots.strip()
    spawn = parse_spawn(p.spawn, world.spawn)
    if not text and not p.spawn.strip() and not world.has_spawn:
        return [RobotSpec("", model, free_place(world, spawn, model))]
    if not text:
        return [RobotSpec("", model, spawn)]
    if text.isdecimal():
        count = parse_count(text)
        names = [f"robot_{i}" for i in range(1, count + 1)]
        return [RobotSpec(name, model, pose) for name, pose in zip(names, free_places(world, spawn, count, model))]
    return [
        RobotSpec(request.name, load(request.model) if request.model else model, request.pose)
        for request in parse_robots(text)
    ]
