"""The package's compiled libraries: how they are found, loaded and checked."""

import ctypes
import os
from typing import Any, List, Optional, Tuple

import numpy as np

from . import __path__ as package_folders
from .errors import InstallationError

BUILD = "build the catkin workspace (./robocop setup, or catkin_make) and source its setup.bash"


def file_name(name: str) -> str:
    """The file of a library, as CMakeLists.txt names it."""
    return f"libaro_robocop_goto_as_{name}.so"


def find(name: str) -> str:
    """A library's path: CMake puts it into the Python package, in devel space and in install space.

    In devel space that folder and the sources are both in the package's __path__. InstallationError when it is missing.
    """
    for folder in package_folders:
        path = os.path.join(folder, file_name(name))
        if os.path.isfile(path):
            return path
    raise InstallationError(f"{file_name(name)} is in none of {', '.join(package_folders)}: {BUILD}")


def load(name: str, version: int) -> ctypes.PyDLL:
    """Load a library. Its calls hold the GIL, so only one thread at a time runs in it.

    InstallationError when it is missing, can't be loaded, or was built from other sources: their version differs.
    """
    path = find(name)
    try:
        library = ctypes.PyDLL(path)
        built = getattr(library, f"aro_{name}_version")()
    except (OSError, AttributeError) as error:
        raise InstallationError(f"{path} can't be used ({error}): {BUILD}") from error
    if built != version:
        raise InstallationError(f"{path} has version {built}, these sources need version {version}: {BUILD}")
    return library


def members(kind: Any, names: str) -> List[Tuple[str, Any]]:
    """Members of the same type, for the `_fields_` of a ctypes.Structure."""
    return [(name, kind) for name in names.split()]


def address(name: str, array: np.ndarray, shape: Tuple[Optional[int], ...], dtype: type = np.float64) -> int:
    """The address of an array's data for C; None in `shape`: any length.

    ValueError unless the array is contiguous and has exactly this type and shape: C could read beyond its end.
    """
    if array.dtype.type is not dtype or not array.dtype.isnative or not array.flags.c_contiguous:
        got = f"{array.dtype}, strides {array.strides}"
        raise ValueError(f"{name}: expected a C-contiguous array of {np.dtype(dtype)}, got {got}")
    if len(array.shape) != len(shape) or any(size not in (None, have) for size, have in zip(shape, array.shape)):
        expected: List[object] = ["any" if size is None else size for size in shape]
        raise ValueError(f"{name}: expected shape {tuple(expected)}, got {array.shape}")
    return int(array.__array_interface__["data"][0])
