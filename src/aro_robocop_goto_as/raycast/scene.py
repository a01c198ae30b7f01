"""Scanners and all that they see, laid out in memory for the compiled ray caster."""

import ctypes
from typing import Optional, Sequence

import numpy as np

from ..compiled import address
from .caster_library import PlaneStruct, SceneStruct, load
from .cross_section import CrossSection

NO_BODIES = np.zeros((0, 3))
NO_OWNERS = np.zeros(0, np.int64)


class ScanPlane:
    """What scanners at one height see: a world's cross-section and circles fixed to robots."""

    def __init__(self, walls: CrossSection, bodies: np.ndarray = NO_BODIES, owners: np.ndarray = NO_OWNERS) -> None:
        """Bodies (b, [x, y, radius]) [m], each in the frame of the robot that owners (b,) names by its index."""
        self.walls = walls
        self.bodies, self.owners = bodies, owners
        self._moved_bodies = np.empty_like(bodies)
        self.struct = PlaneStruct(
            len(walls.segments),
            len(walls.circles),
            len(bodies),
            address("segments", walls.segments, (None, 2, 2)),
            address("circles", walls.circles, (None, 3)),
            address("bodies", bodies, (None, 3)),
            address("owners", owners, (len(bodies),), np.int64),
            address("moved_bodies", self._moved_bodies, (len(bodies), 3)),
            None if walls.tiles is None else ctypes.pointer(walls.tiles.struct),
        )
        self._tiles = walls.tiles  # the structure points into it


class Scene:
    """Robots with a scanner each, and what each scanner sees."""

    def __init__(
        self,
        planes: Sequence[ScanPlane],
        plane_of: Sequence[int],
        mounts: np.ndarray,
        footprints: Optional[np.ndarray] = None,
    ) -> None:
        """Robot i's scanner is at `mounts[i]` [x m, y m, yaw rad] in the robot's frame, in the plane `plane_of[i]`.

        footprints: (n, 3) [x m, y m, yaw rad] in the world, where the robots are at each scan; zeros if none are given
        """
        self.aro_cast = load().aro_cast
        self._plane_of = np.array(plane_of, dtype=np.int64)
        count = len(self._plane_of)
        if any(not 0 <= plane < len(planes) for plane in plane_of):
            raise ValueError(f"plane_of: expected numbers from 0 to {len(planes) - 1}, got {list(plane_of)}")
        if any(not 0 <= owner < count for plane in planes for owner in plane.owners):
            raise ValueError(f"owners: expected numbers from 0 to {count - 1}")
        self.footprints = np.zeros((count, 3)) if footprints is None else footprints
        self._mounts = mounts
        self._planes = list(planes)
        self._plane_structs = (PlaneStruct * len(planes))(*(plane.struct for plane in planes))
        self.struct = SceneStruct(
            count,
            len(planes),
            address("footprints", self.footprints, (count, 3)),
            address("mounts", mounts, (count, 3)),
            address("plane_of", self._plane_of, (count,), np.int64),
            self._plane_structs,
        )
