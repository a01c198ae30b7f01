"""Exact distances along a fan of evenly spaced beams, for any number of sensors at once."""

import ctypes
import math
from functools import lru_cache, partial
from typing import Any, Callable, Sequence

import numpy as np

from .. import compiled
from ..compiled import address, structure
from .cross_section import NO_CIRCLES, CrossSection

TOLERANCE = 1e-9  # [rad] as in caster.c
NO_OWNERS = np.zeros(0, np.int64)
REFUSED = {1: "robots: expected numbers of robots in the scene", 2: "poses: expected finite numbers"}  # as in caster.c

_Beams, _BeamPlane, _BeamScene = (structure("raycast/caster.c", name) for name in ("beams", "beam_plane", "beam_scene"))


def _require_ok(status: Any, _function: object, _arguments: object) -> Any:
    if status:
        raise ValueError(REFUSED[status])
    return status


@lru_cache(maxsize=None)
def load() -> ctypes.PyDLL:
    """The compiled library of caster.c and sensors/lidar.c; InstallationError as compiled.load.

    It holds the GIL during a call, so two threads cannot use the marks of tiles at once.
    """
    library = compiled.load("caster", "raycast/caster.c")
    pointer, integer, unsigned = ctypes.c_void_p, ctypes.c_int64, ctypes.c_uint64
    library.aro_cast.restype, library.aro_cast.errcheck = ctypes.c_int, _require_ok
    library.aro_cast.argtypes = [pointer, pointer, integer, pointer, ctypes.c_double, pointer]
    library.aro_normals.restype = library.aro_measure.restype = None
    library.aro_normals.argtypes = [unsigned, unsigned, unsigned, integer, pointer]
    library.aro_measure.argtypes = [pointer, integer, pointer, pointer, pointer]
    return library


class BeamPlane:
    """What sensors at one height see: a world's cross-section and circles fixed to robots."""

    def __init__(self, section: CrossSection, bodies: np.ndarray = NO_CIRCLES, owners: np.ndarray = NO_OWNERS) -> None:
        """Bodies (b, [x, y, radius]) [m], each in the frame of the robot that owners (b,) names by its index."""
        self.section, self.bodies, self.owners = section, bodies, owners
        self._tiles, self._moved_bodies = section.tiles, np.empty_like(bodies)  # the structure points to them
        self.struct = _BeamPlane(
            len(section.segments),
            len(section.circles),
            len(bodies),
            address("segments", section.segments, (None, 2, 2)),
            address("circles", section.circles, (None, 3)),
            address("bodies", bodies, (None, 3)),
            address("owners", owners, (len(bodies),), np.int64),
            address("moved_bodies", self._moved_bodies, (len(bodies), 3)),
            None if section.tiles is None else ctypes.addressof(section.tiles.struct),
        )


class BeamScene:
    """Robots with a sensor each, and what each sensor sees."""

    def __init__(
        self, planes: Sequence[BeamPlane], plane_of: Sequence[int], mounts: np.ndarray, footprints: np.ndarray
    ) -> None:
        """Robot i's sensor is at `mounts[i]` [x m, y m, yaw rad] in the robot's frame, in the plane `plane_of[i]`.

        footprints: (n, 3) [x m, y m, yaw rad] in the world, where the robots are at each scan
        """
        self._plane_of = np.array(plane_of, dtype=np.int64)
        count = len(self._plane_of)
        self.footprints, self._mounts = footprints, mounts
        self._planes = list(planes)
        self._plane_structs = (_BeamPlane * len(planes))(*(plane.struct for plane in planes))
        struct = _BeamScene(
            count,
            len(planes),
            address("footprints", self.footprints, (count, 3)),
            address("mounts", mounts, (count, 3)),
            address("plane_of", self._plane_of, (count,), np.int64),
            ctypes.addressof(self._plane_structs),
        )
        self._as_parameter_ = ctypes.pointer(struct)  # ctypes passes this, and a call keeps the scene alive

    def __len__(self) -> int:
        return len(self._plane_of)


class Beams:
    """Beams at angle_min + i * increment [rad] in the sensor's frame, i from 0 to samples - 1; increment > 0."""

    def __init__(self, angle_min: float, increment: float, samples: int) -> None:
        self.angle_min = angle_min
        self.increment = increment
        self.samples = samples
        angles = [angle_min + increment * i for i in range(samples)]
        # Not NumPy's sine and cosine: their last bits depend on the processor's vector instructions.
        self._dx, self._dy = (np.array([function(angle) for angle in angles]) for function in (math.cos, math.sin))
        struct = _Beams(
            angle_min,
            1.0 / increment,
            (samples - 1) * increment + 2.0 * TOLERANCE,
            samples,
            address("dx", self._dx, (samples,)),
            address("dy", self._dy, (samples,)),
        )
        self._as_parameter_ = ctypes.pointer(struct)

    def casting(
        self, scene: BeamScene, robots: Sequence[int], max_range: float, distances: np.ndarray
    ) -> Callable[[], object]:
        """A function that casts the beams of these robots' sensors each time it is called.

        It writes to their rows of `distances` (n, samples) [m], +inf where nothing is within max_range [m]. From inside
        a circle its far side is seen; a segment is seen from both sides. A scan does not depend on which other robots
        are in `robots`. ValueError for an unknown robot or a pose that is not finite.
        """
        numbers = (ctypes.c_int64 * len(robots))(*robots)
        address("distances", distances, (len(scene), self.samples))
        return partial(load().aro_cast, self, scene, len(robots), numbers, max_range, distances.ctypes)

    def scan(self, scene: BeamScene, robots: Sequence[int], max_range: float = math.inf) -> np.ndarray:
        """Distances (r, samples) [m] seen now by these robots' sensors, as casting() finds them."""
        distances = np.empty((len(scene), self.samples))
        self.casting(scene, robots, max_range, distances)()
        return distances[list(robots)]

    def cast(self, world_from_scans: np.ndarray, section: CrossSection, reach: float = math.inf) -> np.ndarray:
        """Distances (r, samples) [m] from poses (r, 3) [x m, y m, yaw rad]; +inf where nothing is within `reach` [m].

        For repeated scans in one world a BeamScene is faster.
        """
        poses = np.ascontiguousarray(world_from_scans, dtype=np.float64)
        address("world_from_scans", poses, (None, 3))
        scene = BeamScene([BeamPlane(section)], [0] * len(poses), np.zeros_like(poses), poses)
        return self.scan(scene, range(len(poses)), reach)
