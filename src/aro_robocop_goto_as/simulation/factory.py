"""Parameters -> the simulator: its engine, its robots' limits, its camera renderer."""

from typing import Iterable, Sequence

from ..component_params import EngineParams
from ..params import SimParams
from ..physics.engine import Engine
from ..robot.base_controller import limits_from
from ..robot.model import RobotModel, RobotSpec
from ..world.model import World
from .simulator import Simulator, SimulatorConfig


def make_engine(params: EngineParams, world: World) -> Engine:
    """The physics engine that the parameters ask for; pybullet is imported only where it is used."""
    if params.engine_kind == "kinematic":
        from ..physics.kinematic import KinematicEngine

        return KinematicEngine(world, params.physics_rate, params.footprint_radius)
    from ..physics.bullet import BulletEngine

    return BulletEngine(world, params.physics_rate, params.solver_iterations, params.wheel_torque, params.gui)


def simulator_config(p: SimParams, models: Iterable[RobotModel]) -> SimulatorConfig:
    """The simulator's own parameters."""
    return SimulatorConfig(
        p.rates(),
        p.world_params(),
        p.scanner().spec,
        {model.name: p.camera(model.name) for model in models},
        p.odometry(),
        p.imu_noise(),
        p.localization == "truth",
        p.footprint_radius,
    )


def make_simulator(p: SimParams, world: World, robots: Sequence[RobotSpec]) -> Simulator:
    """A simulator of these robots in this world."""
    world = world if p.moving else world.without_motion()
    limits = [limits_from(p.limits(), robot.model.figures) for robot in robots]
    make_renderer = None
    if any(robot.model.base_from_camera is not None for robot in robots):
        from ..sensors.camera_renderer import CameraRenderer

        make_renderer = CameraRenderer
    config = simulator_config(p, [robot.model for robot in robots])
    return Simulator(config, world, make_engine(p.engine(), world), robots, limits, make_renderer)


def footprint_radius(p: SimParams, model: RobotModel) -> float:
    """The radius [m] of a robot's footprint."""
    return model.figures.footprint_radius if p.footprint_radius is None else p.footprint_radius
