"""A kinematic engine: ideal differential drives, each a disc that is blocked by walls and by other robots.

Each step moves a disc along the chord of its arc as far as the way is free, which is computed exactly, so it passes
through nothing at any speed or step length. Rotation is never blocked. Wheels turn as commanded even where a robot is
blocked, so its encoders keep counting, as those of slipping wheels do.
"""

import math
from typing import Dict, List, Optional, Sequence, Set, Tuple

import numpy as np

from ..geometry import STANDSTILL, Pose2D, Pose3D, Twist2D, arc, quaternion_from_rpy, wrap_angle
from ..raycast.cross_section import FEW, Slice
from ..raycast.grid_index import Tiles
from ..raycast.surroundings import body_heights
from ..robot.model import BodyState, Pair, RobotModel, RobotState
from ..world.model import World
from .swept_disc import (
    CONTACT_MARGIN,
    distances_to_segments,
    end_circles,
    fraction_to_circles,
    fraction_to_sides,
    with_margin,
)

NEARBY = 1.0  # [m] the range within which walls are looked up in an index


class _Walls:
    """The union of a world's cross-sections at several heights [m]: segments (indexed if many) and circles."""

    def __init__(self, world: World, heights: Tuple[float, ...], time: float) -> None:
        self._slices = [Slice(world, height) for height in heights]
        self.segments = np.unique(np.concatenate([cut.segments for cut in self._slices]), axis=0)
        self.tiles = Tiles(self.segments) if len(self.segments) > FEW else None
        self._moving = bool(world.moving())
        self.circles = self._circles_at(time)

    def move(self, time: float) -> float:
        """Move the moving circles to where they are at a time [s]; returns the largest distance moved [m]."""
        before, self.circles = self.circles, self._circles_at(time)
        return float(np.hypot(*(self.circles[:, :2] - before[:, :2]).T).max(initial=0.0))

    def _circles_at(self, time: float) -> np.ndarray:
        """All circles (k, 3) [m] at a time [s], always in the same order.

        Where nothing moves, duplicates from different heights are removed, which is faster.
        """
        circles = np.concatenate([cut.at(time).circles for cut in self._slices])
        return circles if self._moving else np.unique(circles, axis=0)


class _Robot:
    """The state of one robot."""

    def __init__(self, model: RobotModel, radius: float, pose: Pose2D) -> None:
        self.model = model
        self.radius = radius  # [m]
        self.heights = body_heights(model)
        self.wheel_angles: Pair = (0.0, 0.0)  # [rad]
        self.place(pose)

    def place(self, pose: Pose2D) -> None:
        """Stand still at a pose."""
        self.pose = pose
        self.twist = STANDSTILL
        self.set_wheel_speeds((0.0, 0.0))
        self.clearance = 0.0  # [m] it can travel before walls must be looked at again; a lower bound
        self.blocked = False

    def set_wheel_speeds(self, speeds: Pair) -> None:
        """Wheel speeds [rad/s], and the twist that they amount to where nothing blocks the robot."""
        left, right = self.wheel_speeds = speeds
        radius = self.model.wheel_radius
        self.free_twist = Twist2D((left + right) * radius / 2.0, (right - left) * radius / self.model.wheel_separation)


class KinematicEngine:
    """Kinematic discs in one world; see physics.engine for the interface."""

    def __init__(self, world: World, rate: int, radius: Optional[float] = None) -> None:
        """Stepped at `rate` [Hz]; `radius` [m] of all robots, None for each model's own."""
        self._dt = 1.0 / rate
        self._radius = radius
        self._robots: List[_Robot] = []
        self._walls: Dict[Tuple[float, ...], _Walls] = {}  # by the heights of the robots that they block
        self.change_world(world, 0.0)
        self._separation = 0.0  # [m] any two robots can travel together before they meet; a lower bound

    def change_world(self, world: World, time: float) -> None:
        """Replace the world by another one, with its moving obstacles as they are at a time [s]."""
        self._world, self._time = world, time
        self._walls = {heights: _Walls(world, heights, time) for heights in self._walls}
        for robot in self._robots:
            robot.clearance = 0.0

    def move_obstacles(self, time: float) -> None:
        """Put the moving obstacles where they are at a time [s].

        Robots in their way are pushed, but not into walls or other robots.
        """
        self._time = time
        travelled = max([walls.move(time) for walls in self._walls.values()], default=0.0)
        for i, robot in enumerate(self._robots):
            robot.clearance -= travelled
            if robot.clearance < 0.0:
                self._push(i)

    def _push(self, i: int) -> None:
        """Push a robot radially out of the circle that overlaps it most, if one does."""
        robot = self._robots[i]
        centre = np.array([robot.pose.x, robot.pose.y])
        circles = self._walls[robot.heights].circles
        if not len(circles):
            return
        offsets = centre - circles[:, :2]
        distances = np.hypot(offsets[:, 0], offsets[:, 1])
        depths = circles[:, 2] + robot.radius + CONTACT_MARGIN - distances
        deepest = int(depths.argmax())
        if depths[deepest] > 0.0 and distances[deepest] > 0.0:
            push = offsets[deepest] * (depths[deepest] / distances[deepest])
            length = float(depths[deepest])
            fraction = min(
                self._fraction_to_walls(robot, centre, push, length), self._fraction_to_others(i, centre, push, length)
            )
            self._separation = 0.0
            x, y = (centre + push * fraction).tolist()
            robot.pose = Pose2D(x, y, robot.pose.yaw)
            robot.blocked = True

    def add_robot(self, model: RobotModel, world_from_footprint: Pose2D) -> int:
        """Place a robot at rest; returns its index."""
        radius = model.figures.footprint_radius if self._radius is None else self._radius
        robot = _Robot(model, radius, world_from_footprint)
        if robot.heights not in self._walls:
            self._walls[robot.heights] = _Walls(self._world, robot.heights, self._time)
        self._robots.append(robot)
        self._separation = 0.0
        return len(self._robots) - 1

    def place(self, robot: int, world_from_footprint: Pose2D) -> None:
        """Place a robot elsewhere, at rest; its wheels keep their angles."""
        self._robots[robot].place(world_from_footprint)
        self._separation = 0.0

    def reset(self, poses: Sequence[Pose2D]) -> None:
        """Place all robots at rest at these poses, wheels at angle 0, with moving obstacles back at their start."""
        self.move_obstacles(0.0)
        self._robots = [_Robot(robot.model, robot.radius, pose) for robot, pose in zip(self._robots, poses)]
        self._separation = 0.0

    def set_wheel_speeds(self, robot: int, wheel_speeds: Pair) -> None:
        """Speeds [rad/s] of the left and right wheel from the next step on."""
        self._robots[robot].set_wheel_speeds(wheel_speeds)

    def step(self) -> None:
        """Advance all robots by one step, one after the other; each meets the others where they are by then."""
        dt = self._dt
        crowded = self._robots_near_others()
        for i, robot in enumerate(self._robots):
            v, w = robot.free_twist.v, robot.free_twist.w
            left, right = robot.wheel_speeds
            robot.wheel_angles = robot.wheel_angles[0] + left * dt, robot.wheel_angles[1] + right * dt
            x, y, yaw = robot.pose.x, robot.pose.y, robot.pose.yaw
            fraction = 1.0
            if v:
                dx, dy = arc(yaw, v * dt, w * dt)
                robot.clearance -= abs(v * dt)  # no chord is longer than its arc
                if robot.clearance < 0.0 or i in crowded:
                    fraction = self._free_fraction(i, np.array([dx, dy]), i in crowded)
                x, y = x + fraction * dx, y + fraction * dy
            robot.pose = Pose2D(x, y, wrap_angle(yaw + w * dt))
            robot.twist = robot.free_twist if fraction == 1.0 else Twist2D(v * fraction, w)
            robot.blocked = fraction < 1.0

    def _robots_near_others(self) -> Set[int]:
        """The robots that may meet another one in this step."""
        if len(self._robots) == 1:
            return set()
        longest = max(abs(robot.free_twist.v) for robot in self._robots) * self._dt
        self._separation -= 2.0 * longest
        if self._separation >= 0.0:
            return set()
        centres = np.array([(robot.pose.x, robot.pose.y) for robot in self._robots])
        between = np.hypot(centres[:, 0:1] - centres[:, 0], centres[:, 1:2] - centres[:, 1])
        np.fill_diagonal(between, np.inf)
        radii = np.array([robot.radius for robot in self._robots])
        free = between - (radii[:, None] + radii) - 2.0 * (longest + CONTACT_MARGIN)
        self._separation = float(free.min())
        return set(np.flatnonzero((free < 0.0).any(axis=1)).tolist())

    def _free_fraction(self, i: int, move: np.ndarray, crowded: bool) -> float:
        """The fraction of a robot's displacement (2,) [m] that is free, from 0 to 1."""
        robot, length = self._robots[i], math.hypot(*move)
        centre = np.array([robot.pose.x, robot.pose.y])
        fraction = self._fraction_to_walls(robot, centre, move, length) if robot.clearance < 0.0 else 1.0
        return min(fraction, self._fraction_to_others(i, centre, move, length)) if crowded else fraction

    def _fraction_to_others(self, i: int, centre: np.ndarray, move: np.ndarray, length: float) -> float:
        """The fraction of a displacement (2,) [m] that is free of other robots."""
        circles = self._others(i) + [0.0, 0.0, self._robots[i].radius + CONTACT_MARGIN]
        return with_margin(fraction_to_circles(centre, move, circles), length)

    def _fraction_to_walls(self, robot: _Robot, centre: np.ndarray, move: np.ndarray, length: float) -> float:
        """The fraction of a displacement (2,) [m] that is free of walls; renews the robot's clearance."""
        segments = self._nearby_segments(robot, centre, length)
        gap = self._gap(robot, centre, segments) - CONTACT_MARGIN
        robot.clearance = gap - length  # after this step
        if gap >= length:
            return 1.0
        circles = self._walls[robot.heights].circles
        inflated = np.concatenate([circles + [0.0, 0.0, robot.radius], end_circles(segments, robot.radius)])
        fraction = min(
            fraction_to_circles(centre, move, inflated), fraction_to_sides(centre, move, segments, robot.radius)
        )
        return with_margin(fraction, length)

    def _nearby_segments(self, robot: _Robot, centre: np.ndarray, length: float = 0.0) -> np.ndarray:
        """All segments, or with an index at least those within NEARBY of a robot that moves by a length [m]."""
        walls = self._walls[robot.heights]
        if walls.tiles is None:
            return walls.segments
        return walls.segments[walls.tiles.near(float(centre[0]), float(centre[1]), robot.radius + length + NEARBY)]

    def _gap(self, robot: _Robot, centre: np.ndarray, segments: np.ndarray) -> float:
        """Distance [m] from a robot's rim to the nearest wall, with an index at most NEARBY; negative inside a wall."""
        walls = self._walls[robot.heights]
        limit = np.inf if walls.tiles is None else robot.radius + NEARBY
        to_circles = np.hypot(*(walls.circles[:, :2] - centre).T) - walls.circles[:, 2]
        distances = np.concatenate([distances_to_segments(centre, segments), to_circles, [limit]])
        return float(distances.min()) - robot.radius

    def _others(self, i: int) -> np.ndarray:
        """The other robots as circles (n - 1, 3) [m]."""
        others = [(robot.pose.x, robot.pose.y, robot.radius) for k, robot in enumerate(self._robots) if k != i]
        return np.array(others).reshape(-1, 3)

    def state(self, robot: int) -> RobotState:
        """One robot seen from above, after the last step."""
        r = self._robots[robot]
        return RobotState(r.pose, r.twist, r.wheel_angles, r.wheel_speeds)

    def body(self, robot: int) -> BodyState:
        """One robot's base_link in space, after the last step."""
        r = self._robots[robot]
        (x, y, yaw), (v, w) = (r.pose.x, r.pose.y, r.pose.yaw), (r.twist.v, r.twist.w)
        pose = Pose3D((x, y, r.model.footprint_from_base.position[2]), quaternion_from_rpy(0.0, 0.0, yaw))
        return BodyState(pose, (v * math.cos(yaw), v * math.sin(yaw), 0.0), (0.0, 0.0, w))

    def touching(self, robot: int) -> bool:
        """Whether the robot was blocked or pushed in the last step, or overlaps a wall or another robot."""
        r = self._robots[robot]
        centre = np.array([r.pose.x, r.pose.y])
        others = self._others(robot)
        overlaps = np.hypot(*(others[:, :2] - centre).T) < others[:, 2] + r.radius
        return r.blocked or self._gap(r, centre, self._nearby_segments(r, centre)) < 0.0 or bool(overlaps.any())

    def close(self) -> None:
        """Nothing to free."""
