"""The compiled library of raycast and sensors.lidar, and the C structures of the ray caster.

caster.c casts rays, and sensors/lidar.c makes ranges with noise of exact distances.
"""

import ctypes
import functools
from typing import Any

from .. import compiled
from ..compiled import members

VERSION = 7  # of the structures below and of sensors.lidar, as in caster.c
REFUSED = {1: "robots: expected numbers of robots in the scene", 2: "poses: expected finite numbers"}  # as in caster.c


class BeamsStruct(ctypes.Structure):
    """`struct beams` of caster.c."""

    _fields_ = [
        *members(ctypes.c_double, "angle_min per_angle end"),
        ("samples", ctypes.c_int64),
        *members(ctypes.c_void_p, "dx dy"),
    ]


class GridStruct(ctypes.Structure):
    """`struct grid` of grid.h."""

    _fields_ = [
        *members(ctypes.c_double, "x y side"),
        *members(ctypes.c_int64, "columns rows"),
        *members(ctypes.c_void_p, "starts members"),
        ("n_everywhere", ctypes.c_int64),
        *members(ctypes.c_void_p, "everywhere tile_marks segment_marks"),
        ("mark", ctypes.c_int64),
    ]


class BeamPlaneStruct(ctypes.Structure):
    """`struct beam_plane` of caster.c."""

    _fields_ = [
        *members(ctypes.c_int64, "n_segments n_circles n_bodies"),
        *members(ctypes.c_void_p, "segments circles bodies owners moved_bodies"),
        ("grid", ctypes.POINTER(GridStruct)),
    ]


class BeamSceneStruct(ctypes.Structure):
    """`struct beam_scene` of caster.c."""

    _fields_ = [
        *members(ctypes.c_int64, "n_robots n_planes"),
        *members(ctypes.c_void_p, "footprints mounts plane_of"),
        ("planes", ctypes.POINTER(BeamPlaneStruct)),
    ]


def _require_ok(status: Any, _function: object, _arguments: object) -> Any:
    if status:
        raise ValueError(REFUSED[status])
    return status


@functools.lru_cache(maxsize=None)
def load() -> ctypes.PyDLL:
    """The library. It holds the GIL during a call, so two threads cannot use a grid's marks at once.

    InstallationError when it is missing, can't be loaded, or was built from other sources.
    """
    library = compiled.load("caster", VERSION)
    pointer, integer, unsigned = ctypes.c_void_p, ctypes.c_int64, ctypes.c_uint64
    library.aro_cast.restype, library.aro_cast.errcheck = ctypes.c_int, _require_ok
    library.aro_cast.argtypes = [pointer, pointer, integer, pointer, ctypes.c_double, pointer]
    library.aro_normals.restype = library.aro_measure.restype = None
    library.aro_normals.argtypes = [unsigned, unsigned, unsigned, integer, pointer]
    library.aro_measure.argtypes = [pointer, integer, pointer, pointer, pointer]
    return library
