"""The loop drive -> physics -> sensors, step by step, with simulated time counted in whole steps."""

from dataclasses import dataclass
from typing import Dict, FrozenSet, List, Mapping, Optional, Sequence, Union

import numpy as np

from . import drive
from .geometry import Pose2D, Twist2D, compose, compose3, inverse
from .kinematics import Kinematics
from .occupancy import occupancy_of
from .odometers import Odometers
from .params import SimParams
from .physics import Physics
from .renderer import Renderer
from .robot import BodyState, RobotModel, RobotState
from .scanners import Scanners
from .sensors import imu as imu_sensor
from .sensors import magnetometer
from .sensors.camera import CameraImage
from .sensors.imu import ImuSample
from .sensors.lidar import Lidar
from .sensors.odometry import Odometry
from .shapes import Occupancy, World
from .simtime import due, stamp_ns

SCAN, ODOM, JOINTS, IMU, TRUTH, CLOCK, CONTROL = "scan", "odom", "joints", "imu", "ground_truth", "clock", "control"
BUMPER, BATTERY, FIELD, CAMERA = "bumper", "battery", "magnetic_field", "camera"
FAST = frozenset((IMU, FIELD))  # due on most steps, and seldom listened to
SENSORS = (SCAN, ODOM, JOINTS, IMU, TRUTH, BUMPER, BATTERY, FIELD, CAMERA)
SLIP = 2 ** 32  # number of a noise, beyond those of all robots' sensors
Wanted = Mapping[str, Sequence[int]]  # sensor -> the robots it is wanted of


@dataclass(frozen=True)
class RobotSpec:
    """One robot of the world: its name (a ROS namespace; empty for a lone one), what it is, where it starts."""

    name: str
    model: RobotModel
    spawn: Pose2D


@dataclass(frozen=True)
class Observations:
    """What one step brought, all of it at one simulated time; None = not due on this step, or not wanted.

    Sequences hold all robots in order; mappings only those that were wanted, by index.
    """

    stamp_ns: int
    clock: bool
    control: bool
    scans: Mapping[int, np.ndarray]  # ranges (samples,) [m] in base_scan
    imus: Mapping[int, ImuSample]
    bumpers: Mapping[int, bool]  # whether it touches anything but the floor
    fields: Mapping[int, np.ndarray]  # magnetic, (3,) [T] in imu_link
    images: Mapping[int, CameraImage]
    battery: bool = False
    odometry: Optional[Sequence[Odometry]] = None
    joints: Optional[Sequence[RobotState]] = None
    ground_truth: Optional[Sequence[RobotState]] = None


class Simulator:
    """Robots in one world. Not thread-safe: one thread owns it, as Bullet asks for."""

    def __init__(self, params: SimParams, world: World, robots: Sequence[RobotSpec]) -> None:
        self.params = params
        self.world = world = self._as_asked(world)
        self.robots = tuple(robots)
        self.seed = params.seed
        self.steps = 0
        self._noise_origin = 0
        self._noise = np.random.Generator(np.random.Philox(0))
        self._noise_state = self._noise.bit_generator.state
        self.dt = 1.0 / params.physics_rate
        self.lidar = Lidar(params.scanner().spec)
        self._limits = [drive.limits_from(params, robot.model.figures) for robot in robots]
        self._physics: Union[Physics, Kinematics] = (
            Physics(world, params.physics_rate, params.solver_iterations, params.gui) if params.drive == "wheels"
            else Kinematics(world, params.physics_rate, params.footprint_radius))
        for robot in self.robots:
            self._physics.add_robot(robot.model, robot.spawn, params.wheel_torque)
        self._scanners = Scanners([robot.model for robot in robots], world)
        self._renderer: Optional[Renderer] = None  # only where an image has been asked for
        self.moving = bool(world.moving())
        self._schedule = self._make_schedule()
        self._start()

    def _as_asked(self, world: World) -> World:
        """A world with what moves in it, or without."""
        return world if self.params.moving or not world.moving() else world.standing()

    def change_world(self, world: World) -> None:
        """Another world from the next step on, such as world_edits makes of this one; a reset keeps it."""
        self.world = self._as_asked(world)
        self.moving = bool(self.world.moving())
        self._scanners.change_world(self.world)
        self._forget_renderer()
        self._physics.change_world(self.world, self.world_time)

    def _start(self) -> None:
        """All robots stand at their spawn poses, odometry at zero."""
        self._drives = [drive.STANDING for _ in self.robots]
        self._odometers = Odometers(self.params, [robot.model for robot in self.robots], self._states())
        self._map_from_odom = [robot.spawn for robot in self.robots]

    def _states(self) -> List[RobotState]:
        """All robots as of the last step."""
        return [self._physics.state(robot) for robot in range(len(self.robots))]

    def _make_schedule(self) -> List[FrozenSet[str]]:
        """What is due on each step of a second; every second is alike, as all rates are whole numbers."""
        p = self.params
        rates = {SCAN: p.scanner().rate, ODOM: p.odom_rate, JOINTS: p.joint_state_rate, IMU: p.imu_rate,
                 TRUTH: p.ground_truth_rate, BUMPER: p.bumper_rate, BATTERY: p.battery_state_rate,
                 FIELD: p.magnetic_field_rate, CAMERA: p.camera_rate, CLOCK: p.clock_rate, CONTROL: p.control_rate}
        return [frozenset(name for name, rate in rates.items() if rate and due(step, rate, p.physics_rate))
                for step in range(1, p.physics_rate + 1)]

    @property
    def stamp_ns(self) -> int:
        """Simulated time [ns] of the last step; never moves backwards, a reset included."""
        return stamp_ns(self.steps, self.params.physics_rate)

    @property
    def time(self) -> float:
        """Simulated time [s] of the last step."""
        return self.steps / self.params.physics_rate

    @property
    def world_time(self) -> float:
        """Simulated time [s] since the last reset, of which the poses of moving obstacles are a function."""
        return (self.steps - self._noise_origin) / self.params.physics_rate

    def everything(self) -> Dict[str, Sequence[int]]:
        """All sensors of all robots."""
        return {sensor: range(len(self.robots)) for sensor in SENSORS}

    def command(self, twist: Twist2D, robot: int = 0) -> None:
        """Take a velocity command; CommandError on NaN or infinity leaves the one before in force."""
        self._drives[robot] = drive.accept(self._drives[robot], twist, self.time, self._limits[robot])

    def step(self, wanted: Wanted) -> Optional[Observations]:
        """Advance by one physics step, then measure what is due and wanted; None when nothing is due."""
        due_now = self._schedule[self.steps % self.params.physics_rate]
        imus = wanted.get(IMU, ()) if IMU in due_now else ()
        before = {robot: self._physics.body(robot) for robot in imus}
        self._turn_wheels()
        self._physics.step()
        self.steps += 1
        if self.moving:
            self._physics.move(self.world_time)
        fields = wanted.get(FIELD, ()) if FIELD in due_now else ()
        if not due_now or (due_now <= FAST and not imus and not fields):
            return None
        # Odometry is integrated whether it is wanted or not; the state is read only where something needs it.
        asked = {sensor for sensor in (SCAN, JOINTS, TRUTH) if sensor in due_now and wanted.get(sensor)}
        states = self._states() if asked or ODOM in due_now else None
        return Observations(
            self.stamp_ns, CLOCK in due_now, CONTROL in due_now,
            scans=self._scan(states, wanted[SCAN]) if states is not None and SCAN in asked else {},
            imus={robot: self._imu(robot, body) for robot, body in before.items()},
            bumpers={robot: self.touching(robot) for robot in wanted.get(BUMPER, ())} if BUMPER in due_now else {},
            fields={robot: self._field(robot) for robot in fields},
            images=self._images(wanted[CAMERA]) if CAMERA in due_now and wanted.get(CAMERA) else {},
            battery=BATTERY in due_now,
            odometry=self._update_odometry(states) if states is not None and ODOM in due_now else None,
            joints=self._joints(states) if states is not None and JOINTS in asked else None,
            ground_truth=states if TRUTH in asked else None)

    def _turn_wheels(self) -> None:
        """Each robot's wheels as its command, its limits and the time-out have them."""
        now = self.time
        for robot, before in enumerate(self._drives):
            after = drive.advance(before, now, self.dt, self._limits[robot])
            if after is not before:
                self._drives[robot] = after
                model = self.robots[robot].model
                self._physics.drive(robot, drive.wheel_speeds(after.velocity, model.wheel_radius,
                                                              model.wheel_separation))

    def _rng(self, sensor: int) -> np.random.Generator:
        """Noise of one sensor on this step: a function of seed, sensor and steps since the reset, whoever listens."""
        step = self.steps - self._noise_origin
        # A new Philox would ask the system for entropy first, which costs more than the noise.
        self._noise.bit_generator.state = {**self._noise_state, "state": {
            "counter": np.array([0, 0, 0, step], np.uint64), "key": np.array([self.seed, sensor], np.uint64)}}
        return self._noise

    def _scan(self, states: Sequence[RobotState], robots: Sequence[int]) -> Dict[int, np.ndarray]:
        rng = self._rng(0)
        lidar = self.lidar.next_turn(rng)
        distances = self._distances(lidar, states, robots)
        # Drawn for all robots, so that one robot's noise does not depend on whether another is listened to.
        noise = rng.standard_normal((len(self.robots), lidar.spec.samples))
        return dict(zip(robots, lidar.measure(distances, noise[list(robots)])))

    def _distances(self, lidar: Lidar, states: Sequence[RobotState], robots: Sequence[int]) -> np.ndarray:
        return self._scanners.distances(lidar, [state.world_from_base for state in states], robots, self.world_time)

    def occupancy(self) -> Occupancy:
        """The world as a grid map in its own frame: the one it was made of, else cut at the first robot's scanner."""
        if self.world.occupancy is not None:
            return self.world.occupancy
        return occupancy_of(self._scanners.walls(0), self.world.spawn, self.params.map_resolution)

    def exact_distances(self, robot: int = 0) -> np.ndarray:
        """What a scanner would measure now without noise or range_min (samples,) [m]; no return = +inf."""
        return self._distances(self.lidar, self._states(), [robot])[0]

    def _update_odometry(self, states: Sequence[RobotState]) -> Sequence[Odometry]:
        if self._odometers.slipping:
            self._odometers.slip(states, self._rng(SLIP).standard_normal((len(self.robots), 2)))
        latest = self._odometers.update(states)
        if self.params.localization == "truth":
            self._map_from_odom = [compose(state.world_from_base, inverse(it.odom_from_base))
                                   for state, it in zip(states, latest)]
        return latest

    def _joints(self, states: Sequence[RobotState]) -> Sequence[RobotState]:
        """Wheel angles as encoders show them."""
        if not self.params.encoder_tick:
            return states
        return [state._replace(wheel_angles=self._odometers.read(state.wheel_angles)) for state in states]

    def _field(self, robot: int) -> np.ndarray:
        world_from_imu = compose3(self._physics.body(robot).world_from_base, self.robots[robot].model.base_from_imu)
        return magnetometer.measure(world_from_imu.orientation)

    def _imu(self, robot: int, before: BodyState) -> ImuSample:
        rng = self._rng(1 + robot)
        return imu_sensor.measure(before, self._physics.body(robot), self.dt, self.robots[robot].model.base_from_imu,
                                  self.params.gyro_noise, self.params.accelerometer_noise, rng)

    def _images(self, robots: Sequence[int]) -> Dict[int, CameraImage]:
        """Of those robots that have a camera; the first one makes what they are rendered with."""
        models = [robot.model for robot in self.robots]
        if self._renderer is None:
            self._renderer = Renderer(self.world, models)
        bases = [self._physics.body(robot).world_from_base for robot in range(len(models))]
        found = {}
        for robot in robots:
            base_from_camera = models[robot].base_from_camera
            if base_from_camera is not None:
                found[robot] = self._renderer.render(self.params.camera(), compose3(bases[robot], base_from_camera),
                                                     robot, bases, self.world_time)
        return found

    def _forget_renderer(self) -> None:
        if self._renderer is not None:
            self._renderer.close()
            self._renderer = None

    def map_from_odom(self, robot: int = 0) -> Pose2D:
        """Where the odometry's origin is in the map."""
        return self._map_from_odom[robot]

    def world_from_base(self, robot: int = 0) -> Pose2D:
        """The robot's true pose as of the last step."""
        return self._physics.state(robot).world_from_base

    def velocity(self, robot: int = 0) -> Twist2D:
        """The robot's true velocity as of the last step."""
        return self._physics.state(robot).twist

    def touching(self, robot: int = 0) -> bool:
        """Whether the robot touches anything but the floor."""
        return self._physics.touching(robot)

    def leaning(self, robot: int = 0) -> float:
        """Angle [rad] between the robot's mast and the vertical."""
        return self._physics.body(robot).lean()

    def place(self, world_from_base: Pose2D, robot: int = 0) -> None:
        """Set a robot down elsewhere, at rest; odometry goes on, so map -> odom takes up the jump."""
        self._physics.place(robot, world_from_base)
        self._drives[robot] = drive.STANDING
        self._map_from_odom[robot] = compose(world_from_base, inverse(self._odometers.latest[robot].odom_from_base))

    def reset(self, seed: Optional[int] = None, restart_time: bool = False) -> None:
        """Robots to their spawn poses, odometry to zero, noise from its start, of `seed` if one is given.

        Simulated time goes on, unless `restart_time` sets it back to zero.
        """
        self._physics.reset([robot.spawn for robot in self.robots])
        self._start()
        self.seed = self.seed if seed is None else seed
        self.steps = 0 if restart_time else self.steps
        self._noise_origin = self.steps

    def close(self) -> None:
        """Give the physics back."""
        self._forget_renderer()
        self._physics.close()
