"""Robots in a world, advanced and measured step by step in simulated time."""

import enum
import math
from typing import Optional, Sequence, Set

import numpy as np

from ..errors import PlaceError
from ..floor_plan.obstacle_distance import ObstacleDistance
from ..floor_plan.occupancy import occupancy_of
from ..geometry import Pose2D, Twist2D, compose, inverse
from ..physics.engine import Engine
from ..robot.base_controller import clamped
from ..robot.fleet import Fleet
from ..robot.model import RobotSpec
from ..sensors.catalog import Sensors
from ..sensors.sensor import SensorContext
from ..world.model import Occupancy, World
from .agenda import Agenda, StepEvents, Subscriptions, stamp_ns
from .params import SimParams


class Change(enum.Enum):
    """What has changed other than by a step."""

    PAUSED = "paused or resumed"
    RESET = "robots are at their spawn poses, with odometry at zero"
    FRAMES = "map -> odom of a robot has jumped"
    WORLD = "the world was replaced"


class Simulator:
    """The robots of one world. Owned by one thread, as Bullet requires."""

    def __init__(self, params: SimParams, world: World, engine: Engine, robots: Sequence[RobotSpec]) -> None:
        """`engine` holds the same world and the robots' fleet."""
        self.params = params
        self.world = world
        self.models_at_start = frozenset(world.models)  # names
        self.robots = tuple(robots)
        self.steps = 0
        self.rate = params.rates.physics_rate  # [Hz]
        self.engine = engine
        self.context = SensorContext(world, engine, self.rate, params.world.seed)
        self.sensors = Sensors(params.sensors, self.context, params.topics.localization == "truth")
        self._agenda = Agenda(self.sensors, self.context, params.rates)
        self.changes: Set[Change] = set()  # since somebody emptied it
        self.resets = 0
        self.placed = [0] * len(robots)  # how often each robot was placed; the reset places all of them
        self._newly_placed: Set[int] = set()
        self.moving = False  # whether any obstacle of the world moves
        self.reset()

    # -- time --

    @property
    def stamp_ns(self) -> int:
        """Simulated time [ns] of the last step."""
        return stamp_ns(self.steps, self.rate)

    @property
    def time(self) -> float:
        """Simulated time [s] of the last step."""
        return self.steps / self.rate

    @property
    def world_time(self) -> float:
        """Simulated time [s] since the last reset; the poses of moving obstacles are functions of it."""
        return self.context.time

    @property
    def seed(self) -> int:
        """The seed of all noise."""
        return self.context.episode.seed

    # -- steps --

    def command(self, twist: Twist2D, robot: int = 0) -> None:
        """Set a robot's velocity command, clamped to its limits, from now on.

        CommandError on NaN or infinity leaves the previous command in force.
        """
        fleet = self.engine.fleet
        fleet.commands[robot], fleet.commanded_at[robot] = clamped(twist, fleet.limits[robot]), self.time

    def advance(self, subscriptions: Subscriptions, most: int = 1) -> Optional[StepEvents]:
        """Run to the next step on which something is due, and measure it; None if that is more than `most` steps on.

        What is measured, for the robots that are subscribed to, is in the arrays of `sensors`.
        """
        steps, due = self._agenda.after(self.steps, subscriptions)
        if steps > most:
            self._run(most)
            return None
        measure, before = due.prepared
        if before:
            self._run(steps - 1)
            for look in before:
                look()
            steps = 1
        self._run(steps)
        for call in measure:
            call()
        return due

    def _run(self, steps: int) -> None:
        for at_once in [1] * steps if self.moving else [steps]:
            self.engine.advance(self.steps, at_once)
            self.steps += at_once
            self.context.episode.step += at_once
            if self.moving:
                self.engine.move_obstacles(self.world_time)
        if self.moving:
            self.context.scenes.move(self.world_time)

    # -- the state of the world and of its robots --

    @property
    def fleet(self) -> Fleet:
        """The robots' commands and true states, after the last step."""
        self.engine.update_fleet()
        return self.engine.fleet

    def exact_distances(self, robot: int = 0) -> np.ndarray:
        """What the lidar would measure now without noise and range_min: (samples,) [m]; no return = +inf."""
        self.engine.update_fleet()
        return self.sensors.lidar.exact_distances(robot)

    def map_from_odom(self, robot: int = 0) -> Pose2D:
        """Pose of the robot's odom frame in the map."""
        return Pose2D(*self.sensors.odometry.map_from_odom[robot].tolist())

    def world_from_footprint(self, robot: int = 0) -> Pose2D:
        """The robot's true pose after the last step."""
        return self.fleet.pose(robot)

    def velocity(self, robot: int = 0) -> Twist2D:
        """The robot's true velocity after the last step."""
        return self.fleet.state(robot).twist

    def touching(self, robot: int = 0) -> bool:
        """Return whether the robot touches anything but the floor."""
        return self.engine.touching(robot)

    def newly_placed_in_contact(self) -> Sequence[int]:
        """Robots placed since the last call that are in contact: physics pushes them out, or they are stuck."""
        if not self._newly_placed:
            return []
        placed, self._newly_placed = self._newly_placed, set()
        return [robot for robot in sorted(placed) if self.touching(robot)]

    def occupancy(self) -> Occupancy:
        """The world as an occupancy grid: its own map, or a cut at the height of the first robot's lidar.

        In that cut, the area is free that robots can reach from their spawns and from their present places.
        """
        if self.world.occupancy is not None:
            return self.world.occupancy
        model = self.robots[0].model
        section = self.context.scenes.section(model.height_of(model.base_from_scan))
        poses = [self.world_from_footprint(robot) for robot in range(len(self.robots))]
        starts = [*(robot.spawn for robot in self.robots), *poses]
        return occupancy_of(section.segments, section.circles_at_start, starts, self.params.world.map_resolution)

    # -- changes from outside --

    def change_world(self, world: World) -> None:
        """Replace the world from the next step on; a reset keeps the new one."""
        self.world = world.with_motion(self.params.world.moving)
        self.moving = bool(self.world.moving())
        self._close_sensors()
        self.context.change_world(self.world)
        self._agenda.prepare()
        self.engine.change_world(self.world, self.world_time)
        self._newly_placed.update(range(len(self.robots)))
        self.changes.add(Change.WORLD)

    def place(self, world_from_footprint: Pose2D, robot: int = 0) -> None:
        """Place a robot elsewhere, at rest. Its wheel odometry does not notice, so map -> odom jumps instead.

        What the wheels have turned since the last update of odometry counts as driven before the jump.
        """
        self.engine.update_fleet()
        odom_from_footprint = self.sensors.odometry.pose_now(robot)
        self.engine.place(robot, world_from_footprint)
        self._newly_placed.add(robot)
        self.placed[robot] += 1
        self.changes.add(Change.FRAMES)
        if not self.sensors.odometry.in_world:
            self.sensors.odometry.map_from_odom[robot] = compose(world_from_footprint, inverse(odom_from_footprint))

    def require_room(self, pose: Pose2D, robot: int = 0) -> None:
        """PlaceError, naming what is in the way, if a robot's footprint at a pose overlaps something."""
        x, y, fleet = pose.x, pose.y, self.fleet
        radii = fleet.radii.tolist()
        nearest = ObstacleDistance(self.world, self.robots[robot].model.body_heights(), self.world_time).nearest(x, y)
        if nearest.distance < radii[robot]:
            raise PlaceError(
                f"x {x:.3f} y {y:.3f} is {nearest.distance:.3f} m from '{nearest.name}', expected at least the robot's "
                f"radius of {radii[robot]:g} m"
            )
        for index, other in enumerate(self.robots):
            stands = fleet.pose(index)
            distance, least = math.hypot(stands.x - x, stands.y - y), radii[robot] + radii[index]
            if index != robot and distance < least:
                raise PlaceError(
                    f"x {x:.3f} y {y:.3f} is {distance:.3f} m from robot '{other.name}', expected at least {least:g} m"
                )

    def reset(self, seed: Optional[int] = None) -> None:
        """Put robots at their spawn poses, odometry to zero, noise to its start, with a new seed if one is given.

        Simulated time continues.
        """
        spawns = [robot.spawn for robot in self.robots]
        self.moving = bool(self.world.moving())
        self.engine.reset(spawns)
        self.engine.update_fleet()
        for sensor in self.sensors.by_topic.values():
            sensor.reset(spawns)
        self.context.reset(self.seed if seed is None else seed)
        self._newly_placed = set(range(len(self.robots)))
        self.placed = [count + 1 for count in self.placed]
        self.resets += 1
        self.changes |= {Change.RESET, Change.FRAMES}

    def close(self) -> None:
        """Free the engine and the renderer."""
        self._close_sensors()
        self.engine.close()

    def _close_sensors(self) -> None:
        for sensor in self.sensors.by_topic.values():
            sensor.close()
