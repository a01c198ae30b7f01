"""Robots in a world, advanced and measured step by step in simulated time."""

from dataclasses import dataclass
from typing import Dict, FrozenSet, List, Mapping, Optional, Sequence

import numpy as np

from ..component_params import ImuNoise, OdometryParams, Rates, WorldParams
from ..geometry import Pose2D, Twist2D, compose, compose3, inverse
from ..physics.engine import Engine
from ..raycast.scanners import Scanners
from ..robot import base_controller
from ..robot.base_controller import Limits
from ..robot.model import BodyState, RobotSpec, RobotState
from ..sensors import imu, magnetometer
from ..sensors.camera import CameraImage, CameraSpec
from ..sensors.fleet_odometry import Odometers
from ..sensors.imu import ImuSample
from ..sensors.lidar import Lidar
from ..sensors.noise import NoiseStreams
from ..sensors.odometry import Odometry
from ..sensors.scan_profiles import LidarSpec
from ..world.model import Occupancy, World
from ..world.occupancy_grid import occupancy_of
from .cameras import Cameras, MakeRenderer
from .clock import due, stamp_ns
from .observations import (
    BATTERY,
    BUMPER,
    CAMERA,
    GROUND_TRUTH,
    IMU,
    JOINTS,
    MAGNETIC_FIELD,
    ODOM,
    SCAN,
    SENSORS,
    TF,
    Observations,
    RobotTransforms,
    Subscriptions,
)
from .room import require_room

CLOCK, CONTROL = "clock", "control"  # scheduled as sensors are
EVERY_STEP = frozenset((IMU, MAGNETIC_FIELD))  # due on most steps and seldom subscribed to
SLIP_STREAM = 2**32  # noise stream of the wheels' slip; the sensors' streams are numbered from 0 up

Robots = Sequence[int]  # indices


@dataclass(frozen=True)
class SimulatorConfig:
    """The parameters that the simulator itself needs."""

    rates: Rates
    world: WorldParams
    lidar: LidarSpec
    cameras: Mapping[str, CameraSpec]  # by the models' names
    odometry: OdometryParams
    imu_noise: ImuNoise
    true_localization: bool = False  # map -> odom is corrected from ground truth at each odometry update
    footprint_radius: Optional[float] = None  # [m] of all robots; None: each model's own


class Simulator:
    """The robots of one world. Owned by one thread, as Bullet requires."""

    def __init__(
        self,
        config: SimulatorConfig,
        world: World,
        engine: Engine,
        robots: Sequence[RobotSpec],
        limits: Sequence[Limits],
        make_renderer: Optional[MakeRenderer] = None,
    ) -> None:
        """`engine` holds the same world and no robot yet; `limits` one set per robot; without a renderer no images."""
        self.config = config
        self.world = world
        self.robots = tuple(robots)
        self.seed = config.world.seed
        self.steps = 0
        self.dt = 1.0 / config.rates.physics
        self.lidar = Lidar(config.lidar)
        self._reset_step = 0  # step of the last reset, from which noise and moving obstacles count
        self._noise = NoiseStreams()
        self._limits = tuple(limits)
        self.moving = bool(world.moving())
        self.engine = engine
        for robot in self.robots:
            engine.add_robot(robot.model, robot.spawn)
        self._scanners = Scanners([robot.model for robot in self.robots], world)
        self.cameras = Cameras([robot.model for robot in self.robots], config.cameras, make_renderer)
        self._schedule = _schedule(config.rates)
        self._start()

    def _start(self) -> None:
        """All robots stand at their spawn poses, with odometry at zero."""
        self._controllers = [base_controller.STANDING for _ in self.robots]
        self._odometers = Odometers(self.config.odometry, [robot.model for robot in self.robots], self._states())
        self._map_from_odom = [Pose2D() if self._odometers.in_world else robot.spawn for robot in self.robots]

    # -- time --

    @property
    def stamp_ns(self) -> int:
        """Simulated time [ns] of the last step. It moves backwards only in a reset that restarts time."""
        return stamp_ns(self.steps, self.config.rates.physics)

    @property
    def time(self) -> float:
        """Simulated time [s] of the last step."""
        return self.steps / self.config.rates.physics

    @property
    def world_time(self) -> float:
        """Simulated time [s] since the last reset; the poses of moving obstacles are functions of it."""
        return (self.steps - self._reset_step) / self.config.rates.physics

    # -- one step --

    def command(self, twist: Twist2D, robot: int = 0) -> None:
        """Set a robot's velocity command; CommandError on NaN or infinity leaves the previous command in force."""
        self._controllers[robot] = base_controller.accept(
            self._controllers[robot], twist, self.time, self._limits[robot]
        )

    def step(self, subscriptions: Subscriptions) -> Optional[Observations]:
        """Advance by one physics step, then measure what is due and subscribed to; None when nothing is due."""
        scheduled = self._schedule[self.steps % self.config.rates.physics]
        bodies_before = {robot: self.engine.body(robot) for robot in _due(IMU, scheduled, subscriptions)}
        self._advance()
        if not scheduled or (scheduled <= EVERY_STEP and not any(map(subscriptions.get, scheduled))):
            return None
        return self._measure(scheduled, subscriptions, bodies_before)

    def _advance(self) -> None:
        """Base controllers -> wheel speeds -> engine, by one step."""
        now = self.time
        for robot, before in enumerate(self._controllers):
            after = base_controller.advance(before, now, self.dt, self._limits[robot])
            if after is not before:
                self._controllers[robot] = after
                model = self.robots[robot].model
                self.engine.set_wheel_speeds(
                    robot, base_controller.wheel_speeds(after.velocity, model.wheel_radius, model.wheel_separation)
                )
        self.engine.step()
        self.steps += 1
        if self.moving:
            self.engine.move_obstacles(self.world_time)

    def _measure(
        self, scheduled: FrozenSet[str], subscriptions: Subscriptions, bodies_before: Mapping[int, BodyState]
    ) -> Observations:
        """Measure what is due now. Odometry is integrated whenever it is due, whether or not anybody subscribes."""
        due_for = {sensor: _due(sensor, scheduled, subscriptions) for sensor in SENSORS if sensor in scheduled}
        needs_states = ODOM in scheduled or any(due_for.get(sensor) for sensor in (SCAN, JOINTS, GROUND_TRUTH))
        states = self._states() if needs_states else []
        odometry = self._update_odometry(states) if ODOM in scheduled else self._odometers.latest
        return Observations(
            self.stamp_ns,
            CLOCK in scheduled,
            CONTROL in scheduled,
            scans=self._scan(states, due_for.get(SCAN, ())),
            odometry={robot: odometry[robot] for robot in due_for.get(ODOM, ())},
            transforms={
                robot: RobotTransforms(self._map_from_odom[robot], odometry[robot].odom_from_footprint)
                for robot in due_for.get(TF, ())
            },
            joints={robot: self._odometers.joint_state(states[robot]) for robot in due_for.get(JOINTS, ())},
            imus={robot: self._imu(robot, before) for robot, before in bodies_before.items()},
            ground_truth={robot: states[robot] for robot in due_for.get(GROUND_TRUTH, ())},
            bumpers={robot: self.touching(robot) for robot in due_for.get(BUMPER, ())},
            batteries=due_for.get(BATTERY, ()),
            magnetic_fields={robot: self._magnetic_field(robot) for robot in due_for.get(MAGNETIC_FIELD, ())},
            images=self._images(due_for.get(CAMERA, ())),
        )

    def _states(self) -> List[RobotState]:
        return [self.engine.state(robot) for robot in range(len(self.robots))]

    # -- sensors --

    def _noise_of(self, stream: int) -> np.random.Generator:
        """Noise of one stream on this step, counted from the last reset."""
        return self._noise.at(self.seed, stream, self.steps - self._reset_step)

    def _scan(self, states: Sequence[RobotState], robots: Robots) -> Dict[int, np.ndarray]:
        if not robots:
            return {}
        rng = self._noise_of(0)
        lidar = self.lidar.next_turn(rng)
        distances = self._distances(lidar, states, robots)
        # Drawn for all robots, so that one robot's noise does not depend on who subscribes to another's scan.
        noise = rng.standard_normal((len(self.robots), lidar.spec.samples))
        return dict(zip(robots, lidar.measure(distances, noise[list(robots)])))

    def _distances(self, lidar: Lidar, states: Sequence[RobotState], robots: Robots) -> np.ndarray:
        poses = [state.world_from_footprint for state in states]
        return self._scanners.distances(lidar.fan, lidar.spec.range_max, poses, robots, self.world_time)

    def exact_distances(self, robot: int = 0) -> np.ndarray:
        """What the scanner would measure now without noise and range_min: (n_beams,) [m]; no return = +inf."""
        return self._distances(self.lidar, self._states(), [robot])[0]

    def _update_odometry(self, states: Sequence[RobotState]) -> Sequence[Odometry]:
        if self._odometers.slipping:
            self._odometers.slip(states, self._noise_of(SLIP_STREAM).standard_normal((len(self.robots), 2)))
        latest = self._odometers.update(states)
        if self.config.true_localization:
            self._map_from_odom = [
                compose(state.world_from_footprint, inverse(odometry.odom_from_footprint))
                for state, odometry in zip(states, latest)
            ]
        return latest

    def _magnetic_field(self, robot: int) -> np.ndarray:
        world_from_imu = compose3(self.engine.body(robot).world_from_base, self.robots[robot].model.base_from_imu)
        return magnetometer.measure(world_from_imu.orientation)

    def _imu(self, robot: int, before: BodyState) -> ImuSample:
        base_from_imu, noise = self.robots[robot].model.base_from_imu, self.config.imu_noise
        return imu.measure(before, self.engine.body(robot), self.dt, base_from_imu, noise, self._noise_of(1 + robot))

    def _images(self, robots: Robots) -> Dict[int, CameraImage]:
        if not robots:
            return {}
        bases = [self.engine.body(robot).world_from_base for robot in range(len(self.robots))]
        return self.cameras.images(self.world, bases, robots, self.world_time)

    # -- the state of the world and of its robots --

    def map_from_odom(self, robot: int = 0) -> Pose2D:
        """Pose of the robot's odom frame in the map."""
        return self._map_from_odom[robot]

    def world_from_footprint(self, robot: int = 0) -> Pose2D:
        """The robot's true pose after the last step."""
        return self.engine.state(robot).world_from_footprint

    def velocity(self, robot: int = 0) -> Twist2D:
        """The robot's true velocity after the last step."""
        return self.engine.state(robot).twist

    def touching(self, robot: int = 0) -> bool:
        """Whether the robot touches anything but the floor."""
        return self.engine.touching(robot)

    def occupancy(self) -> Occupancy:
        """The world as an occupancy grid: its own map, or a cut at the height of the first robot's scanner.

        In that cut, what robots can reach from their spawns and from where they are is free.
        """
        if self.world.occupancy is not None:
            return self.world.occupancy
        walls = self._scanners.walls(0)
        poses = [self.world_from_footprint(robot) for robot in range(len(self.robots))]
        starts = [*(robot.spawn for robot in self.robots), *poses]
        return occupancy_of(walls.segments, walls.circles, starts, self.config.world.map_resolution)

    def require_room(self, world_from_footprint: Pose2D, robot: int = 0) -> None:
        """PlaceError, naming what is in the way, if a robot's footprint overlaps an obstacle or a robot at a pose."""
        poses = [self.world_from_footprint(index) for index in range(len(self.robots))]
        require_room(
            self.world, self.world_time, self.robots, poses, self._footprint_radius, world_from_footprint, robot
        )

    def _footprint_radius(self, robot: int) -> float:
        given = self.config.footprint_radius
        return self.robots[robot].model.figures.footprint_radius if given is None else given

    # -- changes from outside --

    def change_world(self, world: World) -> None:
        """Replace the world from the next step on; a reset keeps the new one."""
        self.world = world if self.config.world.moving else world.without_motion()
        self.moving = bool(self.world.moving())
        self._scanners.change_world(self.world)
        self.cameras.close()
        self.engine.change_world(self.world, self.world_time)

    def place(self, world_from_footprint: Pose2D, robot: int = 0) -> None:
        """Place a robot elsewhere, at rest. Wheel odometry continues, so map -> odom absorbs the jump.

        What the wheels have travelled since the last odometry update belongs to the time before the jump.
        """
        odom_from_footprint = self._odometers.pose_now(robot, self.engine.state(robot))
        self.engine.place(robot, world_from_footprint)
        self._controllers[robot] = base_controller.STANDING
        if self._odometers.in_world:
            return
        self._map_from_odom[robot] = compose(world_from_footprint, inverse(odom_from_footprint))

    def reset(self, seed: Optional[int] = None, restart_time: bool = False) -> None:
        """Robots to their spawn poses, odometry to zero, noise to its start, with a new seed if one is given.

        Simulated time continues, unless `restart_time` sets it back to zero.
        """
        self.engine.reset([robot.spawn for robot in self.robots])
        self._start()
        self.seed = self.seed if seed is None else seed
        self.steps = 0 if restart_time else self.steps
        self._reset_step = self.steps

    def close(self) -> None:
        """Free the engine and the renderer."""
        self.cameras.close()
        self.engine.close()


def _due(sensor: str, scheduled: FrozenSet[str], subscriptions: Subscriptions) -> Robots:
    """The robots for which a sensor is due and subscribed to."""
    return subscriptions.get(sensor, ()) if sensor in scheduled else ()


def _schedule(rates: Rates) -> List[FrozenSet[str]]:
    """What is due on each step of a second; every second is alike, as all rates are whole numbers."""
    by_name = {name: rate for name, rate in vars(rates).items() if name != "physics"}
    by_name[TF] = rates.odom
    return [
        frozenset(name for name, rate in by_name.items() if rate and due(step, rate, rates.physics))
        for step in range(1, rates.physics + 1)
    ]
