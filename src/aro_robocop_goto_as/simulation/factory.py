"""Parameters and what they name -> the simulator: its fleet, its engine, its camera renderer."""

from typing import Sequence

from ..physics.engine import Engine
from ..robot.base_limits import limits_from
from ..robot.fleet import Fleet
from ..robot.model import RobotSpec
from ..sim_params import EngineParams, SimParams
from ..world.model import World
from .simulator import Simulator


def make_engine(p: EngineParams, world: World, fleet: Fleet, rate: int) -> Engine:
    """The physics engine that the parameters ask for; pybullet is imported only where it is used."""
    if p.drive == "kinematic":
        from ..physics.kinematic import KinematicEngine

        return KinematicEngine(world, fleet, rate)
    from ..physics.bullet import BulletEngine

    return BulletEngine(world, fleet, rate, p.solver_iterations, p.wheel_torque, p.gui)


def make_fleet(p: SimParams, robots: Sequence[RobotSpec]) -> Fleet:
    """The fleet of these robots, with the limits and radii that the parameters give in place of their models' own."""
    models = [robot.model for robot in robots]
    given = p.robots.footprint_radius
    radii = [model.figures.footprint_radius if given is None else given for model in models]
    return Fleet(models, [limits_from(p.limits, model.figures) for model in models], radii)


def make_simulator(p: SimParams, world: World, robots: Sequence[RobotSpec]) -> Simulator:
    """A simulator of these robots in this world."""
    world = world if p.world.moving else world.without_motion()
    make_renderer = None
    if any(robot.model.base_from_camera is not None for robot in robots):
        from ..sensors.camera_renderer import CameraRenderer

        make_renderer = CameraRenderer
    engine = make_engine(p.engine, world, make_fleet(p, robots), p.rates.physics_rate)
    return Simulator(p, world, engine, robots, make_renderer)
