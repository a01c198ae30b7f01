"""The compiled ray caster, and the C structures it works on."""

import ctypes
import functools
from typing import List, Optional, Tuple

import numpy as np

from .. import compiled

VERSION = 1  # of the structures below, as in caster.c


class FanStruct(ctypes.Structure):
    """`struct fan` of caster.c."""

    _fields_ = [
        ("angle_min", ctypes.c_double),
        ("per_angle", ctypes.c_double),
        ("samples", ctypes.c_int64),
        ("turns", ctypes.c_int64),
        ("dx", ctypes.c_void_p),
        ("dy", ctypes.c_void_p),
    ]


class GridStruct(ctypes.Structure):
    """`struct grid` of caster.c."""

    _fields_ = [
        ("x", ctypes.c_double),
        ("y", ctypes.c_double),
        ("side", ctypes.c_double),
        ("columns", ctypes.c_int64),
        ("rows", ctypes.c_int64),
        ("starts", ctypes.c_void_p),
        ("members", ctypes.c_void_p),
        ("n_everywhere", ctypes.c_int64),
        ("everywhere", ctypes.c_void_p),
        ("tile_marks", ctypes.c_void_p),
        ("segment_marks", ctypes.c_void_p),
        ("n_segments", ctypes.c_int64),
        ("mark", ctypes.c_int32),
    ]


class PlaneStruct(ctypes.Structure):
    """`struct plane` of caster.c."""

    _fields_ = [
        ("n_segments", ctypes.c_int64),
        ("n_circles", ctypes.c_int64),
        ("n_bodies", ctypes.c_int64),
        ("segments", ctypes.c_void_p),
        ("circles", ctypes.c_void_p),
        ("bodies", ctypes.c_void_p),
        ("owners", ctypes.c_void_p),
        ("moved_bodies", ctypes.c_void_p),
        ("grid", ctypes.POINTER(GridStruct)),
    ]


class FleetStruct(ctypes.Structure):
    """`struct fleet` of caster.c."""

    _fields_ = [
        ("n_robots", ctypes.c_int64),
        ("n_planes", ctypes.c_int64),
        ("footprints", ctypes.c_void_p),
        ("mounts", ctypes.c_void_p),
        ("plane_of", ctypes.c_void_p),
        ("planes", ctypes.POINTER(PlaneStruct)),
    ]


@functools.lru_cache(maxsize=None)
def load() -> ctypes.PyDLL:
    """The library. It holds the GIL during a call, so two threads cannot use a grid's marks at once.

    InstallationError when it is missing, can't be loaded, or was built from other sources.
    """
    library = compiled.load("caster", VERSION)
    library.aro_cast.restype = ctypes.c_int
    library.aro_cast.argtypes = [
        ctypes.POINTER(FanStruct),
        ctypes.POINTER(FleetStruct),
        ctypes.c_int64,
        ctypes.c_void_p,
        ctypes.c_double,
        ctypes.c_void_p,
    ]
    return library


def address(name: str, array: np.ndarray, shape: Tuple[Optional[int], ...], dtype: type = np.float64) -> int:
    """The address of an array's data for C; None in `shape`: any length.

    ValueError unless it is a contiguous array of exactly this type and shape, as C could read beyond it.
    """
    if not isinstance(array, np.ndarray) or array.dtype != dtype or not array.flags.c_contiguous:
        kind = f"{array.dtype}, strides {array.strides}" if isinstance(array, np.ndarray) else type(array).__name__
        raise ValueError(f"{name}: expected a C-contiguous array of {np.dtype(dtype)}, got {kind}")
    if len(array.shape) != len(shape) or any(size not in (None, have) for size, have in zip(shape, array.shape)):
        expected: List[object] = ["any" if size is None else size for size in shape]
        raise ValueError(f"{name}: expected shape {tuple(expected)}, got {array.shape}")
    return int(array.ctypes.data)
