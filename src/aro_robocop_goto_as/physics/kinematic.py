"""A kinematic engine: ideal differential drives, each a disc that is blocked by walls and by other robots.

Each step moves a disc along the chord of its arc as far as the way is free, which is computed exactly, so it passes
through nothing at any speed or step length. Rotation is never blocked. Wheels turn as commanded even if the robot is
blocked, so its encoders keep counting, as with slipping wheels. kinematic.c does all of this.
"""

import ctypes
import math
from functools import partial
from typing import Callable, Sequence, Tuple

import numpy as np

from ..compiled import address, structure
from ..geometry import Pose2D, Pose3D, quaternion_from_rpy
from ..raycast.cross_section import CrossSection
from ..raycast.tiles import Tiles
from ..robot.fleet import Fleet, library
from ..robot.model import BodyState
from ..world.model import World
from ..world.scripted_motion import moving

_BodySectionStruct = structure("physics/kinematic.c", "body_section")
_KinematicStruct = structure("physics/kinematic.c", "kinematic")


class _BodySection:
    """The obstacles in a robot's way: the union of a world's cross-sections at several heights [m], indexed."""

    def __init__(self, world: World, heights: Tuple[float, ...], time: float) -> None:
        sections = [CrossSection(world, height) for height in heights]
        self._segments = np.unique(np.concatenate([section.segments for section in sections]), axis=0)
        self._tiles = Tiles(self._segments)
        # A pillar is cut at several heights; once each is enough. Motions compare by their values.
        found = dict.fromkeys(
            (*circle, motion)
            for section in sections
            for circle, motion in zip(section.circles.tolist(), section.motions)
        )
        self._circles = np.array([entry[:3] for entry in found], dtype=float).reshape(-1, 3)
        self.move = moving(self._circles, [motion for *_, motion in found])
        self.move(time)
        self.struct = _BodySectionStruct(
            address("segments", self._segments, (None, 2, 2)),
            ctypes.addressof(self._tiles.struct),
            len(self._circles),
            address("circles", self._circles, (None, 3)),
        )


class KinematicEngine:
    """Kinematic discs in one world; see physics.engine for the interface."""

    def __init__(self, world: World, fleet: Fleet, rate: int) -> None:
        """`rate` [Hz] of the steps."""
        n = len(fleet)
        self.fleet = fleet
        heights = [model.body_heights() for model in fleet.models]
        self._heights = sorted(set(heights))
        self._section_of = np.array([self._heights.index(of_one) for of_one in heights], dtype=np.int64)
        self._free_travel, self._blocked, self._crowded = np.zeros(n), np.zeros(n, np.uint8), np.zeros(n, np.uint8)
        self._library = library()
        self._struct = _KinematicStruct(
            ctypes.addressof(fleet.struct),
            None,
            address("section_of", self._section_of, (n,), np.int64),
            address("free_travel", self._free_travel, (n,)),
            address("blocked", self._blocked, (n,), np.uint8),
            address("crowded", self._crowded, (n,), np.uint8),
        )
        self._pointer = ctypes.byref(self._struct)
        self.advance: Callable[[int, int], None] = partial(self._library.aro_kinematic_advance, self._pointer, rate)
        self.change_world(world, 0.0)

    def change_world(self, world: World, time: float) -> None:
        """Replace the world by another one, with its moving obstacles as they are at a time [s]."""
        self._sections = [_BodySection(world, heights, time) for heights in self._heights]
        self._structs = (_BodySectionStruct * len(self._sections))(*(section.struct for section in self._sections))
        self._struct.sections = ctypes.addressof(self._structs)
        self._free_travel[:] = 0.0

    def update_fleet(self) -> None:
        """Nothing to do: the fleet's rows are the state."""

    def move_obstacles(self, time: float) -> None:
        """Put the moving obstacles where they are at a time [s].

        Robots in their way are pushed, but not into walls or other robots.
        """
        travelled = max([section.move(time) for section in self._sections], default=0.0)
        self._library.aro_kinematic_push(self._pointer, travelled)

    def place(self, robot: int, world_from_footprint: Pose2D) -> None:
        """Place a robot elsewhere, at rest; its wheels keep their angles."""
        self.fleet.place(robot, world_from_footprint)
        self._free_travel[robot] = self._blocked[robot] = 0
        self._struct.separation = 0.0

    def reset(self, poses: Sequence[Pose2D]) -> None:
        """Place all robots at rest at these poses, wheels at angle 0, with moving obstacles back at their start."""
        for section in self._sections:
            section.move(0.0)
        self.fleet.wheel_angles[:] = 0.0
        for robot, pose in enumerate(poses):
            self.place(robot, pose)

    def body(self, robot: int) -> BodyState:
        """One robot's base_link in space, after the last step."""
        (x, y, yaw), (v, w) = self.fleet.poses[robot].tolist(), self.fleet.twists[robot].tolist()
        height = self.fleet.models[robot].footprint_from_base.position[2]
        pose = Pose3D((x, y, height), quaternion_from_rpy(0.0, 0.0, yaw))
        return BodyState(pose, (v * math.cos(yaw), v * math.sin(yaw), 0.0), (0.0, 0.0, w))

    def touching(self, robot: int) -> bool:
        """Return whether the robot was blocked or pushed in the last step, or overlaps a wall or another robot."""
        return bool(self._library.aro_kinematic_touching(self._pointer, robot))

    def close(self) -> None:
        """Nothing to free."""
