"""The package's compiled libraries: how they are found, loaded and checked, and the structures that they take."""

import ctypes
import os
import re
from typing import Any, List, Optional, Tuple

import numpy as np

from . import __path__ as package_folders
from .errors import InstallationError

KINDS = {"double": ctypes.c_double, "int64_t": ctypes.c_int64}  # of the numbers in structures, by their C types
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


def source(file: str) -> str:
    """A C file of this package, without its comments."""
    with open(os.path.join(os.path.dirname(__file__), file), encoding="utf-8") as stream:
        return re.sub(r"/\*.*?\*/", "", stream.read(), flags=re.DOTALL)


def load(name: str, file: str) -> ctypes.PyDLL:
    """Load a library. Its calls hold the GIL, so only one thread at a time runs in it.

    InstallationError when it is missing, can't be loaded, or was built from other sources, whose version differs from
    the one in the C file.
    """
    path = find(name)
    version = int(re.findall(r"_VERSION (\d+)", source(file))[0])
    try:
        library = ctypes.PyDLL(path)
        built = getattr(library, f"aro_{name}_version")()
    except (OSError, AttributeError) as error:
        raise InstallationError(f"{path} can't be used ({error}): {BUILD}") from error
    if built != version:
        raise InstallationError(f"{path} has version {built}, these sources need version {version}: {BUILD}")
    return library


def structure(file: str, name: str) -> Any:
    """The `struct` of this name in a C file, as a class of ctypes; its pointers are addresses."""
    (body,) = re.findall(rf"^struct {name} {{(.*?)^}};", source(file), re.DOTALL | re.MULTILINE)
    members = [
        (member.lstrip("*"), ctypes.c_void_p if member.startswith("*") else KINDS[kind])
        for kind, names in re.findall(r"(\w+) (\*?\w+(?:, \*?\w+)*);", body)
        for member in names.split(", ")
    ]
    return type(name, (ctypes.Structure,), {"_fields_": members})


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
