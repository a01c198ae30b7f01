"""Parameters and what they name -> the robots, and the simulator with their fleet and its engine."""

from typing import Callable, List, Sequence

from ..floor_plan.free_places import free_place, free_places
from ..physics.engine import Engine, EngineParams
from ..robot.base_controller import limits_from
from ..robot.fleet import Fleet
from ..robot.model import RobotModel, RobotSpec
from ..world.model import World
from ..world.spawn_texts import parse_count, parse_robots, parse_spawn
from .params import RobotParams, SimParams
from .simulator import Simulator


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
        places = free_places(world, spawn, parse_count(text), model)
        return [RobotSpec(f"robot_{number}", model, pose) for number, pose in enumerate(places, 1)]
    return [
        RobotSpec(request.name, load(request.model) if request.model else model, request.pose)
        for request in parse_robots(text)
    ]


def make_simulator(p: SimParams, world: World, robots: Sequence[RobotSpec]) -> Simulator:
    """A simulator of these robots in this world, with limits and radii as given, else as their models have them."""
    world = world.with_motion(p.world.moving)
    models, radius = [robot.model for robot in robots], p.robots.footprint_radius
    radii = [model.figures.footprint_radius if radius is None else radius for model in models]
    fleet = Fleet(models, [limits_from(p.limits, model.figures) for model in models], radii)
    return Simulator(p, world, _engine(p.engine, world, fleet, p.rates.physics_rate), robots)


def _engine(p: EngineParams, world: World, fleet: Fleet, rate: int) -> Engine:
    """The engine that the parameters ask for; pybullet is imported only where it is used."""
    if p.drive == "kinematic":
        from ..physics.kinematic import KinematicEngine

        return KinematicEngine(world, fleet, rate)
    from ..physics.bullet import BulletEngine

    return BulletEngine(world, fleet, rate, p.solver_iterations, p.wheel_torque, p.gui)
