"""The compiled ray caster: how it is found, and the C structures it works on."""

import ctypes
import functools
import os
from typing import List, Optional, Sequence, Tuple

import numpy as np

from .. import __path__ as package_folders
from ..errors import InstallationError

NAME = "libaro_robocop_goto_as_caster.so"
VERSION = 1  # of the structures below, as in caster.c
BUILD = "build the catkin workspace (./robocop setup, or catkin_make) and source its setup.bash"


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


def find(folders: Optional[Sequence[str]] = None) -> str:
    """The library's path: CMake puts it into the Python package, in devel space and in install space.

    In devel space that folder and the sources are both in the package's __path__. InstallationError when it is missing.
    """
    folders = list(package_folders if folders is None else folders)
    for folder in folders:
        path = os.path.join(folder, NAME)
        if os.path.isfile(path):
            return path
    raise InstallationError(f"{NAME} is in none of {', '.join(folders)}: {BUILD}")


@functools.lru_cache(maxsize=None)
def load(path: Optional[str] = None) -> ctypes.PyDLL:
    """The library; InstallationError when it is missing, can't be loaded, or was built from other sources."""
    path = path or find()
    try:
        # PyDLL holds the GIL during a call, so two threads cannot use a grid's marks at once.
        library = ctypes.PyDLL(path)
        version = library.aro_caster_version()
    except (OSError, AttributeError) as error:
        raise InstallationError(f"{path} can't be used ({error}): {BUILD}") from error
    if version != VERSION:
        raise InstallationError(f"{path} has version {version}, these sources need version {VERSION}: {BUILD}")
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
