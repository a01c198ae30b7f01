"""Robots in a world, advanced and measured step by step in simulated time."""

import functools
from typing import Callable, Dict, FrozenSet, List, NamedTuple, Optional, Sequence, Set, Tuple

import numpy as np

from ..geometry import Pose2D, Twist2D, compose, compose3, inverse
from ..physics.engine import Engine
from ..raycast.occupancy import occupancy_of
from ..raycast.scanners import Scanners
from ..robot.model import BodyState, RobotSpec
from ..sensors import imu, magnetometer
from ..sensors.lidar import Lidar
from ..sensors.noise_streams import NoiseStreams
from ..sensors.odometry import Odometers
from ..sim_params import SimParams
from ..world.model import Occupancy, World
from . import observations
from .cameras import Cameras, MakeRenderer
from .observations import Due, Observations, Robots, Subscriptions
from .room import require_room
from .schedule import Schedule, stamp_ns

CLOCK, CONTROL = "clock", "control"  # scheduled as sensors are
DUE_OFTEN = {observations.IMU, observations.MAGNETIC_FIELD}  # due on most steps and seldom subscribed to
SLIP_STREAM = 2**32  # noise stream of the wheels' slip; the sensors' streams are numbered from 0 up


class _Plan(NamedTuple):
    """What is done on the steps on which the same is due."""

    due: Due
    measures: Sequence[Callable[[], None]]
    imus: Robots  # which compare the states before and after the step


class Simulator:
    """The robots of one world. Owned by one thread, as Bullet requires."""

    def __init__(
        self,
        p: SimParams,
        world: World,
        engine: Engine,
        robots: Sequence[RobotSpec],
        make_renderer: Optional[MakeRenderer] = None,
    ) -> None:
        """`engine` holds the same world and the robots' fleet; without a renderer there are no images."""
        self.p = p
        self.world = world
        self.robots = tuple(robots)
        self.seed = p.world.seed
        self.steps = 0
        self.rate = p.rates.physics_rate  # [Hz]
        self.lidar = Lidar(p.scan.lidar())
        self.engine = engine
        self.fleet = engine.fleet  # up to date after engine.update_fleet()
        self._noise = NoiseStreams()
        models = [robot.model for robot in self.robots]
        self._scanners = Scanners(models, world, self.fleet.poses)
        self.cameras = Cameras(models, p.camera, make_renderer)
        rates = _rates(p)
        self._usual = Schedule({name: rate for name, rate in rates.items() if name not in DUE_OFTEN}, self.rate)
        self._full = Schedule(rates, self.rate)
        self._schedule = self._usual
        self._plans: Dict[Tuple[str, ...], _Plan] = {}  # by the names of what is due, for these subscriptions:
        self._subscriptions: Subscriptions = {}
        self._newly_placed: Set[int] = set()
        self._ranges: Dict[int, np.ndarray] = {}
        n, odometers = len(self.robots), Odometers(p.odometry, self.fleet, p.rates.odom_rate)
        scans = self.ranges(self.lidar.spec.samples)
        self.observed = Observations(
            self.fleet, odometers, np.zeros((n, 3)), np.zeros((n, 2)), np.zeros((n, 10)), scans
        )
        self.reset()

    # -- time --

    @property
    def stamp_ns(self) -> int:
        """Simulated time [ns] of the last step. It moves backwards only in a reset that restarts time."""
        return stamp_ns(self.steps, self.rate)

    @property
    def time(self) -> float:
        """Simulated time [s] of the last step."""
        return self.steps / self.rate

    @property
    def world_time(self) -> float:
        """Simulated time [s] since the last reset; the poses of moving obstacles are functions of it."""
        return (self.steps - self._reset_step) / self.rate

    @property
    def moving(self) -> bool:
        """Whether any obstacle of the world moves."""
        return bool(self._moving)

    # -- steps --

    def command(self, twist: Twist2D, robot: int = 0) -> None:
        """Set a robot's velocity command now, as Fleet.command."""
        self.fleet.command(robot, twist, self.time)

    def step(self, subscriptions: Subscriptions) -> Optional[Observations]:
        """Advance by one step, then measure what is due and subscribed to; None when nothing is due."""
        return self.advance(subscriptions, 1)

    def advance(self, subscriptions: Subscriptions, most: int) -> Optional[Observations]:
        """Run to the next step on which something is due, and measure it; None if that is more than `most` steps on."""
        if subscriptions is not self._subscriptions and subscriptions != self._subscriptions:
            self._subscriptions, self._plans = subscriptions, {}
            self._schedule = self._full if any(map(subscriptions.get, DUE_OFTEN)) else self._usual
        steps, names = self._schedule.after(self.steps)
        if steps > most:
            self._run(most)
            return None
        plan = self._plans.get(names) or self._plan(names)
        if plan.imus:
            self._run(steps - 1)
            before = [self.engine.body(robot) for robot in plan.imus]
            self._run(1)
            self._measure_imus(plan.imus, before)
        else:
            self._run(steps)
        for measure in plan.measures:
            measure()
        self.observed.stamp_ns, self.observed.due = self.stamp_ns, plan.due
        return self.observed

    def _run(self, steps: int) -> None:
        if not self._moving:
            self.engine.advance(self.steps, steps)
            self.steps += steps
            return
        for _ in range(steps):
            self.engine.advance(self.steps, 1)
            self.steps += 1
            self.engine.move_obstacles(self.world_time)

    def _plan(self, names: Tuple[str, ...]) -> _Plan:
        """What is done when these are due. Odometry is integrated whether or not anybody subscribes."""
        due = {name: self._subscriptions[name] for name in names if self._subscriptions.get(name)}
        measures: List[Callable[[], None]] = []
        if (
            observations.ODOM in names
            or {observations.SCAN, observations.GROUND_TRUTH, observations.JOINTS} & due.keys()
        ):
            measures.append(self.engine.update_fleet)
        if observations.ODOM in names:
            measures.append(self._update_odometry)
        for name, measure in (
            (observations.JOINTS, self._read_joints),
            (observations.SCAN, self._scan),
            (observations.BUMPER, self._read_bumpers),
            (observations.MAGNETIC_FIELD, self._measure_magnetic_fields),
            (observations.CAMERA, self._take_images),
        ):
            if name in due:
                measures.append(functools.partial(measure, due[name]))
        self._plans[names] = _Plan(Due(CLOCK in names, CONTROL in names, due), measures, due.get(observations.IMU, ()))
        return self._plans[names]

    def sensors_at_control_ticks(self) -> FrozenSet[str]:
        """The sensors that are due on each control tick."""
        rates = _rates(self.p)
        return frozenset(name for name, rate in rates.items() if rate and rate % rates[CONTROL] == 0)

    # -- sensors --

    def _noise_of(self, stream: int) -> np.random.Generator:
        """Noise of one stream on this step, counted from the last reset."""
        return self._noise.at(self.seed, stream, self.steps - self._reset_step)

    def ranges(self, beams: int) -> np.ndarray:
        """The array (n, beams) [m] to which scans with so many beams are written."""
        return self._ranges.setdefault(beams, np.zeros((len(self.robots), beams)))

    def _scan(self, robots: Robots) -> None:
        lidar = self.lidar.next_turn(self._noise_of(0)) if self.lidar.spec.varying else self.lidar
        distances = self._distances(lidar, robots)
        self.observed.scans = self.ranges(lidar.spec.samples)
        lidar.measure(distances, robots, self.seed, self.steps - self._reset_step, self.observed.scans)

    def _distances(self, lidar: Lidar, robots: Sequence[int]) -> np.ndarray:
        return self._scanners.distances(lidar.fan, lidar.spec.range_max, robots, self.world_time)

    def exact_distances(self, robot: int = 0) -> np.ndarray:
        """What the scanner would measure now without noise and range_min: (n_beams,) [m]; no return = +inf."""
        self.engine.update_fleet()
        return self._distances(self.lidar, [robot])[0]

    def _update_odometry(self) -> None:
        odometers = self.observed.odometry
        shape = len(self.robots), 2
        odometers.update(self._noise_of(SLIP_STREAM).standard_normal(shape) if odometers.slipping else None)
        if self.p.topics.localization == "truth":
            for robot, pose in enumerate(odometers.poses.tolist()):
                self.observed.map_from_odom[robot] = compose(self.fleet.pose(robot), inverse(Pose2D(*pose)))

    def _read_joints(self, _robots: Robots) -> None:
        self.observed.joint_angles[:] = self.observed.odometry.joint_angles()

    def _read_bumpers(self, robots: Robots) -> None:
        self.observed.bumpers = {robot: self.touching(robot) for robot in robots}

    def _measure_magnetic_fields(self, robots: Robots) -> None:
        self.observed.magnetic_fields = {robot: self._magnetic_field(robot) for robot in robots}

    def _magnetic_field(self, robot: int) -> np.ndarray:
        world_from_imu = compose3(self.engine.body(robot).world_from_base, self.robots[robot].model.base_from_imu)
        return magnetometer.measure(world_from_imu.orientation)

    def _measure_imus(self, robots: Robots, bodies_before: Sequence[BodyState]) -> None:
        for robot, before in zip(robots, bodies_before):
            base_from_imu, noise, after = (
                self.robots[robot].model.base_from_imu,
                self._noise_of(1 + robot),
                self.engine.body(robot),
            )
            self.observed.imus[robot] = imu.measure(before, after, 1.0 / self.rate, base_from_imu, self.p.imu, noise)

    def _take_images(self, robots: Robots) -> None:
        bases = [self.engine.body(robot).world_from_base for robot in range(len(self.robots))]
        self.observed.images = self.cameras.images(self.world, bases, robots, self.world_time)

    # -- the state of the world and of its robots --

    def map_from_odom(self, robot: int = 0) -> Pose2D:
        """Pose of the robot's odom frame in the map."""
        return Pose2D(*self.observed.map_from_odom[robot].tolist())

    def world_from_footprint(self, robot: int = 0) -> Pose2D:
        """The robot's true pose after the last step."""
        self.engine.update_fleet()
        return self.fleet.pose(robot)

    def velocity(self, robot: int = 0) -> Twist2D:
        """The robot's true velocity after the last step."""
        self.engine.update_fleet()
        return self.fleet.state(robot).twist

    def touching(self, robot: int = 0) -> bool:
        """Whether the robot touches anything but the floor."""
        return self.engine.touching(robot)

    def newly_placed_in_contact(self) -> Sequence[int]:
        """The robots placed since the last call that are in contact: physics pushes them out, or they are stuck."""
        if not self._newly_placed:
            return []
        placed, self._newly_placed = self._newly_placed, set()
        return [robot for robot in sorted(placed) if self.touching(robot)]

    def occupancy(self) -> Occupancy:
        """The world as an occupancy grid: its own map, or a cut at the height of the first robot's scanner.

        In that cut, what robots can reach from their spawns and from where they are is free.
        """
        if self.world.occupancy is not None:
            return self.world.occupancy
        walls = self._scanners.walls(0)
        poses = [self.world_from_footprint(robot) for robot in range(len(self.robots))]
        starts = [*(robot.spawn for robot in self.robots), *poses]
        return occupancy_of(walls.segments, walls.circles_at_start, starts, self.p.world.map_resolution)

    # -- changes from outside --

    def change_world(self, world: World) -> None:
        """Replace the world from the next step on; a reset keeps the new one."""
        self.world = world if self.p.world.moving else world.without_motion()
        self._moving = self.world.moving()
        self._scanners.change_world(self.world)
        self.cameras.close()
        self.engine.change_world(self.world, self.world_time)
        self._newly_placed.update(range(len(self.robots)))

    def place(self, world_from_footprint: Pose2D, robot: int = 0) -> None:
        """Place a robot elsewhere, at rest. Wheel odometry continues, so map -> odom absorbs the jump.

        What the wheels have travelled since the last odometry update belongs to the time before the jump.
        """
        self.engine.update_fleet()
        odom_from_footprint = self.observed.odometry.pose_now(robot)
        self.engine.place(robot, world_from_footprint)
        self._newly_placed.add(robot)
        if not self.observed.odometry.in_world:
            self.observed.map_from_odom[robot] = compose(world_from_footprint, inverse(odom_from_footprint))

    def place_with_room(self, world_from_footprint: Pose2D, robot: int = 0) -> None:
        """Like place(), but raises PlaceError, naming the obstacle, if the robot would overlap something."""
        self.engine.update_fleet()
        require_room(self.world, self.world_time, self.robots, self.fleet, world_from_footprint, robot)
        self.place(world_from_footprint, robot)

    def reset(self, seed: Optional[int] = None, restart_time: bool = False) -> None:
        """Robots to their spawn poses, odometry to zero, noise to its start, with a new seed if one is given.

        Simulated time continues, unless `restart_time` sets it back to zero.
        """
        spawns = [robot.spawn for robot in self.robots]
        self._moving = self.world.moving()
        self.engine.reset(spawns)
        self.engine.update_fleet()
        self.observed.odometry.reset()
        self.observed.map_from_odom[:] = 0.0 if self.observed.odometry.in_world else spawns
        self.seed = self.seed if seed is None else seed
        self.steps = 0 if restart_time else self.steps
        self._reset_step = self.steps  # from which noise and moving obstacles count
        self._newly_placed = set(range(len(self.robots)))

    def close(self) -> None:
        """Free the engine and the renderer."""
        self.cameras.close()
        self.engine.close()


def _rates(p: SimParams) -> Dict[str, int]:
    """How often each sensor and tick is due [Hz], in the order of their messages; 0 = never."""
    rates = p.rates
    return {
        CLOCK: rates.clock_rate,
        CONTROL: rates.control_rate,
        observations.GROUND_TRUTH: rates.ground_truth_rate,
        observations.IMU: rates.imu_rate,
        observations.JOINTS: rates.joint_state_rate,
        observations.ODOM: rates.odom_rate,
        observations.SCAN: p.scan.rate,
        observations.BUMPER: rates.bumper_rate,
        observations.MAGNETIC_FIELD: rates.magnetic_field_rate,
        observations.BATTERY: rates.battery_state_rate,
        observations.CAMERA: rates.camera_rate,
        observations.TF: rates.odom_rate,
    }
