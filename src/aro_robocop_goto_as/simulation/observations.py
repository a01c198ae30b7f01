"""What one step yields: what is due, and the measurements."""

import functools
from dataclasses import dataclass, field
from typing import Any, Callable, Dict, FrozenSet, List, Mapping, Optional, Sequence

import numpy as np

from ..geometry import Pose2D, compose, compose3, inverse
from ..physics.engine import Engine
from ..raycast.scanners import Scanners
from ..robot.model import BodyState
from ..sensors import imu
from ..sensors.camera import CameraImage, CameraSpec
from ..sensors.lidar import Lidar
from ..sensors.noise_streams import Episode, NoiseStreams
from ..sensors.odometry import Odometers
from ..sim_params import SimParams
from ..world.model import World
from .rates import BUMPER, CAMERA, CLOCK, GROUND_TRUTH, JOINTS, ODOM, SCAN

SLIP_STREAM = 2**32  # noise stream of the wheels' slip; the sensors' streams are numbered from 0 up

Robots = Sequence[int]  # indices
Subscriptions = Mapping[str, Robots]  # sensor -> the robots for which somebody subscribes to it


@dataclass(eq=False)
class Due:
    """What is due on a step; the same object on all steps that are alike, while the subscriptions stay the same."""

    clock: bool = False  # a clock tick: /clock is due
    control: bool = False  # a control tick: the controllers' period is over
    sensors: Subscriptions = field(default_factory=dict)  # those that are due, for whom they are subscribed to
    measures: Sequence[Callable[[], object]] = ()  # the calls that measure them
    names: FrozenSet[str] = field(init=False)  # of these sensors, and CLOCK if it is due

    def __post_init__(self) -> None:
        self.names = frozenset([*self.sensors, *([CLOCK] if self.clock else [])])


class Observations:
    """The sensors of all robots, and what they measured last; one object, changed in place.

    Each array has a row for each robot. A row is new where its sensor was due for its robot.

    fleet: ground truth
    map_from_odom: (n, 3) x, y [m], yaw [rad]
    joint_angles: (n, 2) [rad] as the encoders read them
    imus: (n, 10) as sensors.imu describes
    scans: ranges (n, n_beams) [m] in base_scan; another array where the number of beams varies
    """

    def __init__(self, p: SimParams, world: World, engine: Engine) -> None:
        n, models = len(engine.fleet), engine.fleet.models
        self._world, self._engine, self._models, self._imu_params = world, engine, models, p.imu
        self._follows_truth = p.topics.localization == "truth"  # map -> odom
        self._rate = p.rates.physics_rate  # [Hz]
        self.stamp_ns, self.due = 0, Due()  # of the last step on which something was due [ns]
        self.episode = Episode(p.world.seed, 0)
        self.lidar = Lidar(p.scan.lidar())
        self.scanners = Scanners(models, world, engine.fleet.poses)
        self.fleet, self.odometry = engine.fleet, Odometers(p.odometry, engine.fleet)
        self.map_from_odom, self.joint_angles, self.imus = np.zeros((n, 3)), np.zeros((n, 2)), np.zeros((n, 10))
        self._ranges: Dict[int, np.ndarray] = {}
        self.scans = self.ranges(self.lidar.spec.samples)
        self.bumpers: Mapping[int, bool] = {}  # whether a robot touches anything but the floor
        self.images: Mapping[int, CameraImage] = {}
        self.cameras: Sequence[Optional[CameraSpec]] = [  # None: a model without a camera
            None if model.base_from_camera is None else p.camera.spec(model.name) for model in models
        ]
        self._noise = NoiseStreams(self.episode)
        self._make_renderer: Any = None
        if any(self.cameras):
            from ..sensors.camera_renderer import CameraRenderer  # imports pybullet

            self._make_renderer = CameraRenderer
        self._renderer: Any = None  # a CameraRenderer of this world, made for the first image
        self._measures: Dict[str, Callable[[Robots], object]] = {
            JOINTS: self._read_joints,
            ODOM: self._update_odometry,
            SCAN: self._scan_with_any_number_of_beams,
            BUMPER: self._read_bumpers,
            CAMERA: self._take_images,
        }

    def of(self, sensor: str) -> Robots:
        """The robots for which a sensor is due and subscribed to."""
        return self.due.sensors.get(sensor, ())

    def measures_of(self, names: Sequence[str], due: Subscriptions) -> Sequence[Callable[[], object]]:
        """Functions that measure these sensors, except IMUs. Odometry is integrated even if nobody subscribes.

        The fleet's rows, which are ground truth, are updated first, and no more often than something reads them.
        """
        measures: List[Callable[[], object]] = []
        for name in names:
            if name == SCAN and name in due and not self.lidar.spec.varying:
                measures += self._scanning(self.lidar, due[name])
            elif name == ODOM or (name in due and name in self._measures):
                measures.append(functools.partial(self._measures[name], due.get(name, ())))
        return [self._engine.update_fleet, *measures] if measures or GROUND_TRUTH in due else []

    @property
    def world_time(self) -> float:
        """Simulated time [s] since the last reset; the poses of moving obstacles are functions of it."""
        return self.episode.step / self._rate

    # -- sensors --

    def ranges(self, beams: int) -> np.ndarray:
        """The array (n, beams) [m] to which scans with so many beams are written."""
        return self._ranges.setdefault(beams, np.zeros((len(self._models), beams)))

    def _scanning(self, lidar: Lidar, robots: Robots) -> Sequence[Callable[[], object]]:
        scans = self.ranges(lidar.spec.samples)
        cast = lidar.fan.casting(self.scanners.scene, robots, lidar.spec.range_max, scans)
        return [cast, lidar.measuring(robots, self.episode, scans)]

    def _scan_with_any_number_of_beams(self, robots: Robots) -> None:
        lidar = self.lidar.next_turn(self._noise.stream(0))
        self.scans = self.ranges(lidar.spec.samples)
        for measure in self._scanning(lidar, robots):
            measure()

    def _update_odometry(self, _robots: Robots) -> None:
        if self.odometry.slipping:
            self._noise.stream(SLIP_STREAM).standard_normal(out=self.odometry.noise)
        self.odometry.update()
        if self._follows_truth:
            for robot, pose in enumerate(self.odometry.poses.tolist()):
                self.map_from_odom[robot] = compose(self.fleet.pose(robot), inverse(Pose2D(*pose)))

    def _read_joints(self, _robots: Robots) -> None:
        self.joint_angles[:] = self.odometry.joint_angles()

    def _read_bumpers(self, robots: Robots) -> None:
        self.bumpers = {robot: self._engine.touching(robot) for robot in robots}

    def measure_imus(self, robots: Robots, bodies_before: Sequence[BodyState]) -> None:
        """Measure the IMUs of these robots, given their states before the last step."""
        for robot, before in zip(robots, bodies_before):
            after, mount = self._engine.body(robot), self._models[robot].base_from_imu
            noise = self._noise.stream(1 + robot)
            self.imus[robot] = imu.measure(before, after, 1.0 / self._rate, mount, self._imu_params, noise)

    def _take_images(self, robots: Robots) -> None:
        bases = [self._engine.body(robot).world_from_base for robot in range(len(self._models))]
        images = {}
        for robot in robots:
            spec, base_from_camera = self.cameras[robot], self._models[robot].base_from_camera
            if spec is not None and base_from_camera is not None:
                world_from_camera = compose3(bases[robot], base_from_camera)
                images[robot] = self._renderer_now().render(spec, world_from_camera, robot, bases, self.world_time)
        self.images = images

    def _renderer_now(self) -> Any:
        if self._renderer is None:
            self._renderer = self._make_renderer(self._world, self._models)
        return self._renderer

    def reset(self, seed: int, spawns: Sequence[Pose2D]) -> None:
        """Odometry to zero where the robots are, at their spawn poses; noise and moving obstacles to their start."""
        self.odometry.reset()
        self.map_from_odom[:] = 0.0 if self.odometry.in_world else spawns
        self.episode.seed, self.episode.step = seed, 0
        self.scanners.move(0.0)

    def change_world(self, world: World) -> None:
        """Replace the world."""
        self.close()
        self._world = world
        self.scanners.change_world(world)
        self.scanners.move(self.world_time)

    def close(self) -> None:
        """Free the renderer; the next image makes a new one."""
        if self._renderer is not None:
            self._renderer.close()
            self._renderer = None
