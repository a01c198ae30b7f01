"""World + wheel speeds -> robots on the move, as ideal differential drives that walls and other robots block.

A robot is a disc. Each step moves it along its arc's chord as far as the way is free, worked out exactly, so nothing is
passed through at any speed or step length. Turning is never blocked; wheels turn as commanded, so where a robot is
blocked its encoders count on, as wheels that slip do.
"""

import math
from typing import Dict, List, Sequence, Set, Tuple

import numpy as np

from .geometry import STANDSTILL, Pose2D, Pose3D, Twist2D, arc, quaternion_from_rpy, wrap_angle
from .robot import BodyState, Pair, RobotModel, RobotState
from .slice import FEW, Slice
from .sweep import SKIN, ends, share_to_circles, share_to_sides, short_of, to_segments
from .tiles import Tiles
from .world import World

LOWEST = 0.02  # [m] at which obstacles are met: a bottom plate
SPREAD = 0.09  # [m] at the most from there to the next height, and so on up to the lidar
NEARBY = 1.0  # [m] how far many walls are looked up


class _Walls:
    """What is met at any of a robot's heights [m]: segments, indexed where they are many, and round obstacles."""

    def __init__(self, world: World, heights: Tuple[float, ...], time: float) -> None:
        self._cuts = [Slice(world, height) for height in heights]
        self.segments = np.unique(np.concatenate([cut.segments for cut in self._cuts]), axis=0)
        self.tiles = Tiles(self.segments) if len(self.segments) > FEW else None
        self._moving = bool(world.moving())
        self.circles = self._circles_at(time)

    def move(self, time: float) -> float:
        """Have what moves where it is at a time [s]; how far [m] it came at the most."""
        before, self.circles = self.circles, self._circles_at(time)
        return float(np.hypot(*(self.circles[:, :2] - before[:, :2]).T).max(initial=0.0))

    def _circles_at(self, time: float) -> np.ndarray:
        """All round obstacles (k, 3) [m] as they are at a time [s], always in the same order.

        Where nothing moves, each is there once, not once a height: fewer are faster.
        """
        circles = np.concatenate([cut.at(time).circles for cut in self._cuts])
        return circles if self._moving else np.unique(circles, axis=0)


def _heights(model: RobotModel) -> Tuple[float, ...]:
    """From bottom plate to lidar [m]; of a Burger three, its middle between them."""
    top = model.scan_height
    count = 1 + max(1, math.ceil((top - LOWEST) / SPREAD))
    return tuple(np.linspace(LOWEST, top, count).tolist())


class _Disc:
    """What is kept of one robot."""

    def __init__(self, model: RobotModel, radius: float, pose: Pose2D) -> None:
        self.model = model
        self.radius = radius  # [m]
        self.heights = _heights(model)
        self.wheels: Pair = (0.0, 0.0)  # angles [rad]
        self.set_down(pose)

    def set_down(self, pose: Pose2D) -> None:
        """At rest at a pose."""
        self.pose = pose
        self.twist = STANDSTILL
        self.spin((0.0, 0.0))
        self.room = 0.0  # [m] that it may certainly travel before a wall has to be looked for
        self.blocked = False

    def spin(self, speeds: Pair) -> None:
        """Wheel speeds [rad/s] from now on."""
        left, right = self.spins = speeds
        radius = self.model.wheel_radius
        self.wish = Twist2D((left + right) * radius / 2.0, (right - left) * radius / self.model.wheel_separation)


class Kinematics:
    """The ideal drive; the same interface as Physics, robots addressed in the order they were added."""

    def __init__(self, world: World, rate: int, radius: float = 0.0) -> None:
        """Stepped at `rate` [Hz]; radius [m] of all robots, 0 for each model's own."""
        self._dt = 1.0 / rate
        self._radius = radius
        self._discs: List[_Disc] = []
        self._walls: Dict[Tuple[float, ...], _Walls] = {}  # by the heights of the robots that meet them
        self.change_world(world, 0.0)
        self._apart = 0.0  # [m] that any two robots may certainly travel, both together, before they meet

    def change_world(self, world: World, time: float) -> None:
        """Another world from now on, as it is at a time [s]."""
        self._world, self._time = world, time
        self._walls = {heights: _Walls(world, heights, time) for heights in self._walls}
        for disc in self._discs:
            disc.room = 0.0

    def move(self, time: float) -> None:
        """Have obstacles that move where they are at a time [s]; robots in their way are pushed up to a wall."""
        self._time = time
        travelled = max([walls.move(time) for walls in self._walls.values()], default=0.0)
        for it in self._discs:
            it.room -= travelled
            if it.room < 0.0:
                self._push(it)

    def _push(self, it: _Disc) -> None:
        """Straight away from the round obstacle that is deepest in a robot, if one is."""
        centre = np.array([it.pose.x, it.pose.y])
        circles = self._walls[it.heights].circles
        offsets = centre - circles[:, :2]
        away = np.hypot(offsets[:, 0], offsets[:, 1])
        depths = circles[:, 2] + it.radius + SKIN - away
        deepest = int(depths.argmax())
        if depths[deepest] > 0.0 and away[deepest] > 0.0:
            push = offsets[deepest] * (depths[deepest] / away[deepest])
            x, y = (centre + push * self._share_against_walls(it, centre, push, float(depths[deepest]))).tolist()
            it.pose = Pose2D(x, y, it.pose.yaw)
            it.blocked = True

    def add_robot(self, model: RobotModel, world_from_footprint: Pose2D, wheel_torque: float = 0.0) -> int:
        """Put a robot down; torque is of no account here. Returns its index."""
        it = _Disc(model, self._radius or model.figures.footprint_radius, world_from_footprint)
        if it.heights not in self._walls:
            self._walls[it.heights] = _Walls(self._world, it.heights, self._time)
        self._discs.append(it)
        self._apart = 0.0
        return len(self._discs) - 1

    def place(self, robot: int, world_from_footprint: Pose2D) -> None:
        """Set a robot down at a pose, at rest; its wheels keep their angles."""
        self._discs[robot].set_down(world_from_footprint)
        self._apart = 0.0

    def reset(self, poses: Sequence[Pose2D]) -> None:
        """All robots set down anew at their poses, wheels at angle zero; what moves is back where it began."""
        self.move(0.0)
        self._discs = [_Disc(disc.model, disc.radius, pose) for disc, pose in zip(self._discs, poses)]
        self._apart = 0.0

    def drive(self, robot: int, wheel_speeds: Pair) -> None:
        """Speeds [rad/s] of the left and right wheel from the next step on."""
        self._discs[robot].spin(wheel_speeds)

    def step(self) -> None:
        """Advance every robot by one step, one after the other, each against where the others then are."""
        dt = self._dt
        crowd = self._crowd()
        for i, it in enumerate(self._discs):
            v, w = it.wish.v, it.wish.w
            it.wheels = it.wheels[0] + it.spins[0] * dt, it.wheels[1] + it.spins[1] * dt
            x, y, yaw = it.pose.x, it.pose.y, it.pose.yaw
            share = 1.0
            if v:
                dx, dy = arc(yaw, v * dt, w * dt)
                it.room -= abs(v * dt)  # no chord is longer than its arc
                if it.room < 0.0 or i in crowd:
                    share = self._free_share(i, np.array([dx, dy]), i in crowd)
                x, y = x + share * dx, y + share * dy
            it.pose = Pose2D(x, y, wrap_angle(yaw + w * dt))
            it.twist = it.wish if share == 1.0 else Twist2D(v * share, w)
            it.blocked = share < 1.0

    def _crowd(self) -> Set[int]:
        """The robots that may meet another one in this step."""
        if len(self._discs) == 1:
            return set()
        longest = max(abs(it.wish.v) for it in self._discs) * self._dt
        self._apart -= 2.0 * longest
        if self._apart >= 0.0:
            return set()
        centres = np.array([(it.pose.x, it.pose.y) for it in self._discs])
        between = np.hypot(centres[:, 0:1] - centres[:, 0], centres[:, 1:2] - centres[:, 1])
        np.fill_diagonal(between, np.inf)
        radii = np.array([it.radius for it in self._discs])
        free = between - (radii[:, None] + radii) - 2.0 * (longest + SKIN)
        self._apart = float(free.min())
        return set(np.flatnonzero((free < 0.0).any(axis=1)).tolist())

    def _free_share(self, i: int, move: np.ndarray, crowded: bool) -> float:
        """How much of a robot's displacement (2,) [m] is free, from 0 to 1."""
        it, length = self._discs[i], math.hypot(*move)
        centre = np.array([it.pose.x, it.pose.y])
        share = self._share_against_walls(it, centre, move, length) if it.room < 0.0 else 1.0
        if crowded:
            rings = self._others(i) + [0.0, 0.0, it.radius + SKIN]
            share = min(share, short_of(share_to_circles(centre, move, rings), length))
        return share

    def _share_against_walls(self, it: _Disc, centre: np.ndarray, move: np.ndarray, length: float) -> float:
        """The share that is free of walls; renews the robot's room."""
        segments = self._near(it, centre, length)
        gap = self._gap(it, centre, segments) - SKIN
        it.room = gap - length  # what is left of it after this step
        if gap >= length:
            return 1.0
        circles = self._walls[it.heights].circles
        rounds = np.concatenate([circles + [0.0, 0.0, it.radius], ends(segments, it.radius)])
        free = min(share_to_circles(centre, move, rounds), share_to_sides(centre, move, segments, it.radius))
        return short_of(free, length)

    def _near(self, it: _Disc, centre: np.ndarray, length: float = 0.0) -> np.ndarray:
        """All segments, or of many at least those within NEARBY of a disc that moves from there by a length [m]."""
        walls = self._walls[it.heights]
        if walls.tiles is None:
            return walls.segments
        return walls.segments[walls.tiles.near(float(centre[0]), float(centre[1]), it.radius + length + NEARBY)]

    def _gap(self, it: _Disc, centre: np.ndarray, segments: np.ndarray) -> float:
        """How far [m] a disc at a point (2,) is from the nearest wall, NEARBY at most; negative where it is in one."""
        walls = self._walls[it.heights]
        limit = np.inf if walls.tiles is None else it.radius + NEARBY
        away = np.concatenate([to_segments(centre, segments),
                               np.hypot(*(walls.circles[:, :2] - centre).T) - walls.circles[:, 2], [limit]])
        return float(away.min()) - it.radius

    def _others(self, i: int) -> np.ndarray:
        """The other robots as circles (n - 1, 3) [m]."""
        others = [(it.pose.x, it.pose.y, it.radius) for k, it in enumerate(self._discs) if k != i]
        return np.array(others).reshape(-1, 3)

    def state(self, robot: int) -> RobotState:
        """One robot as of the last step."""
        it = self._discs[robot]
        return RobotState(it.pose, it.twist, it.wheels, it.spins)

    def body(self, robot: int) -> BodyState:
        """One robot's base in space as of the last step."""
        it = self._discs[robot]
        (x, y, yaw), (v, w) = (it.pose.x, it.pose.y, it.pose.yaw), (it.twist.v, it.twist.w)
        pose = Pose3D((x, y, it.model.footprint_from_base.position[2]), quaternion_from_rpy(0.0, 0.0, yaw))
        return BodyState(pose, (v * math.cos(yaw), v * math.sin(yaw), 0.0), (0.0, 0.0, w))

    def touching(self, robot: int) -> bool:
        """Whether something stopped the robot in the last step, or it stands in a wall or another robot."""
        it = self._discs[robot]
        centre = np.array([it.pose.x, it.pose.y])
        others = self._others(robot)
        near = np.hypot(*(others[:, :2] - centre).T) < others[:, 2] + it.radius
        return it.blocked or self._gap(it, centre, self._near(it, centre)) < 0.0 or bool(near.any())

    def close(self) -> None:
        """Nothing to give back."""
