"""World + wheel speeds -> robots on the move, as ideal differential drives that walls and other robots block.

A robot is a disc. Each step moves it along its arc's chord as far as the way is free, worked out exactly, so nothing is
passed through at any speed or step length. Turning is never blocked; wheels turn as commanded, so where a robot is
blocked its encoders count on, as wheels that slip do.
"""

import math
from typing import List, Sequence

import numpy as np

from .geometry import Pose2D, Pose3D, quaternion_from_rpy, row, wrap_rows
from .robot import BodyState, FleetState, RobotModel
from .sensors.odometry import arc
from .slice import Slice
from .world import World

HEIGHTS = (0.02, 0.10, 0.18)  # [m] at which obstacles are met: a Burger's bottom plate, middle, and lidar
SKIN = 1e-6  # [m] kept free, so that rounding never puts a disc inside a wall


class Kinematics:
    """The ideal drive; the same interface as Physics, robots addressed in the order they were added."""

    def __init__(self, world: World, rate: int, radius: float) -> None:
        self._dt = 1.0 / rate
        self._radius = radius
        cuts = [Slice(world, height) for height in HEIGHTS]
        self._segments = np.unique(np.concatenate([cut.segments for cut in cuts]), axis=0)
        self._circles = np.unique(np.concatenate([cut.circles for cut in cuts]), axis=0)
        self._models: List[RobotModel] = []
        self._poses = np.zeros((0, 3))
        self._twists = np.zeros((0, 2))
        self._spins = np.zeros((0, 2))  # wheel speeds [rad/s]
        self._wheels = np.zeros((0, 2))  # wheel angles [rad]
        self._slack = np.zeros(0)  # [m] that each robot may certainly travel before a wall has to be looked for
        self._blocked: List[bool] = []

    def add_robot(self, model: RobotModel, world_from_footprint: Pose2D, wheel_torque: float = 0.0) -> int:
        """Put a robot down; torque is of no account here. Returns its index."""
        self._models.append(model)
        self._poses = np.vstack([self._poses, row(world_from_footprint)])
        self._twists, self._spins, self._wheels = (
            np.vstack([array, np.zeros(2)]) for array in (self._twists, self._spins, self._wheels))
        self._slack = np.append(self._slack, 0.0)
        self._blocked.append(False)
        return len(self._models) - 1

    def place(self, robot: int, world_from_footprint: Pose2D) -> None:
        """Set a robot down at a pose, at rest; its wheels keep their angles."""
        self._poses, self._twists, self._spins = self._poses.copy(), self._twists.copy(), self._spins.copy()
        self._poses[robot] = row(world_from_footprint)
        self._twists[robot] = self._spins[robot] = 0.0
        self._slack[robot] = 0.0

    def reset(self, poses: Sequence[Pose2D]) -> None:
        """All robots set down anew at their poses, wheels at angle zero."""
        for robot, pose in enumerate(poses):
            self.place(robot, pose)
        self._wheels = np.zeros_like(self._wheels)

    def drive(self, wheel_speeds: np.ndarray) -> None:
        """Speeds (n, 2) [rad/s] of the left and right wheels from the next step on."""
        self._spins = wheel_speeds

    def step(self) -> None:
        """Advance every robot by one step."""
        dt, model = self._dt, self._models[0]
        rim = self._spins * model.wheel_radius
        forward, turn = (rim[:, 0] + rim[:, 1]) / 2.0, (rim[:, 1] - rim[:, 0]) / model.wheel_separation
        move = arc(self._poses[:, 2], forward * dt, turn * dt)
        share = self._free_share(move)
        self._poses = np.concatenate([
            self._poses[:, :2] + move * share[:, None], wrap_rows(self._poses[:, 2] + turn * dt)[:, None]], axis=1)
        self._wheels = self._wheels + self._spins * dt
        self._twists = np.stack([forward * share, turn], axis=1)

    def _free_share(self, move: np.ndarray) -> np.ndarray:
        """How much of each displacement (n, 2) [m] is free: shares (n,) from 0 to 1."""
        share = np.ones(len(move))
        self._blocked = [False] * len(move)
        if not move.any():
            return share
        length = np.hypot(move[:, 0], move[:, 1])
        self._slack -= length
        for i in np.flatnonzero((self._slack < 0.0) & (length > 0.0)):
            share[i] = self._share_against_walls(int(i), move[i], float(length[i]))
        if len(move) > 1:
            self._stop_short_of_robots(move, length, share)
        self._blocked = (share < 1.0).tolist()
        return share

    def _share_against_walls(self, i: int, move: np.ndarray, length: float) -> float:
        """The free share against walls for one robot; renews its slack."""
        start = self._poses[i, :2]
        gap = self._room(start) - SKIN
        self._slack[i] = gap - length
        if gap >= length:
            return 1.0
        rounds = np.concatenate([self._circles + [0.0, 0.0, self._radius], _ends(self._segments, self._radius)])
        free = min(_share_to_circles(start, move, rounds), _share_to_sides(start, move, self._segments, self._radius))
        return _short_of(free, length)

    def _room(self, centre: np.ndarray) -> float:
        """How far [m] a disc at a point (2,) is from the nearest wall; negative where it is in one."""
        walls = np.concatenate([_to_segments(centre, self._segments),
                                np.hypot(*(self._circles[:, :2] - centre).T) - self._circles[:, 2], [np.inf]])
        return float(walls.min()) - self._radius

    def _stop_short_of_robots(self, move: np.ndarray, length: np.ndarray, share: np.ndarray) -> None:
        """Cut shares so that no two robots meet; one after the other, each against where the others then are."""
        centres = self._poses[:, :2].copy()
        apart = np.hypot(centres[:, 0:1] - centres[:, 0], centres[:, 1:2] - centres[:, 1])
        np.fill_diagonal(apart, np.inf)
        near = apart < 2.0 * (self._radius + length.max())
        for i in range(len(move)):
            if near[i].any() and length[i] > 0.0:
                others = np.column_stack([centres[near[i]], np.full(near[i].sum(), 2.0 * self._radius + SKIN)])
                share[i] = min(share[i], _short_of(_share_to_circles(centres[i], move[i], others), length[i]))
            centres[i] += share[i] * move[i]

    def state(self) -> FleetState:
        """All robots as of the last step."""
        return FleetState(self._poses, self._twists, self._wheels, self._spins)

    def body(self, robot: int) -> BodyState:
        """One robot's base in space as of the last step."""
        (x, y, yaw), (v, w) = self._poses[robot].tolist(), self._twists[robot].tolist()
        height = self._models[robot].footprint_from_base.position[2]
        pose = Pose3D((x, y, height), quaternion_from_rpy(0.0, 0.0, yaw))
        return BodyState(pose, (v * math.cos(yaw), v * math.sin(yaw), 0.0), (0.0, 0.0, w))

    def touching(self, robot: int) -> bool:
        """Whether something stopped the robot in the last step, or it stands in a wall or another robot."""
        centre = self._poses[robot, :2]
        others = np.hypot(*(np.delete(self._poses[:, :2], robot, axis=0) - centre).T)
        return self._blocked[robot] or self._room(centre) < 0.0 or bool((others < 2.0 * self._radius).any())

    def close(self) -> None:
        """Nothing to give back."""


def _short_of(share: float, length: float) -> float:
    """The share that keeps the skin free; 1 where nothing is met."""
    return share if share >= 1.0 else max(0.0, share - SKIN / length)


def _ends(segments: np.ndarray, radius: float) -> np.ndarray:
    """The ends of segments (m, 2, 2) as circles (2 m, 3) of one radius."""
    points = segments.reshape(-1, 2)
    return np.column_stack([points, np.full(len(points), radius)])


def _to_segments(point: np.ndarray, segments: np.ndarray) -> np.ndarray:
    """Distances (m,) [m] from a point (2,) to segments (m, 2, 2)."""
    start, along = segments[:, 0], segments[:, 1] - segments[:, 0]
    offset = point - start
    share = np.clip((offset * along).sum(axis=1) / np.maximum((along ** 2).sum(axis=1), 1e-30), 0.0, 1.0)
    return np.hypot(*(offset - share[:, None] * along).T)


def _share_to_circles(start: np.ndarray, move: np.ndarray, circles: np.ndarray) -> float:
    """Share of a displacement until it first enters a circle (m, 3); leaving one that it is in is free."""
    if not len(circles):
        return 1.0
    offset = circles[:, :2] - start
    towards = offset @ move
    squared = float(move @ move)
    if squared == 0.0:
        return 1.0
    root = towards ** 2 - squared * ((offset ** 2).sum(axis=1) - circles[:, 2] ** 2)
    share = (towards - np.sqrt(np.maximum(root, 0.0))) / squared
    met = (root > 0.0) & (towards > 0.0) & (share < 1.0)
    return max(0.0, float(share[met].min())) if met.any() else 1.0


def _share_to_sides(start: np.ndarray, move: np.ndarray, segments: np.ndarray, radius: float) -> float:
    """Share of a displacement until it comes within `radius` of the flat side of a segment (m, 2, 2)."""
    if not len(segments):
        return 1.0
    along = segments[:, 1] - segments[:, 0]
    length = np.hypot(along[:, 0], along[:, 1])
    along = along / length[:, None]
    normal = np.stack([-along[:, 1], along[:, 0]], axis=1)
    offset = start - segments[:, 0]
    away = (offset * normal).sum(axis=1)
    side = np.where(away >= 0.0, 1.0, -1.0)
    approach = -(normal @ move) * side
    nearing = approach > 0.0
    share = np.full(len(segments), 1.0)
    share[nearing] = np.maximum((np.abs(away[nearing]) - radius) / approach[nearing], 0.0)
    share = np.minimum(share, 1.0)
    touch = ((offset + share[:, None] * move) * along).sum(axis=1)
    met = (share < 1.0) & (touch >= 0.0) & (touch <= length)
    return float(share[met].min()) if met.any() else 1.0
