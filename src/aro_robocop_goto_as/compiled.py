"""The package's compiled libraries: how they are found, loaded and checked."""

import ctypes
import os
from typing import Optional, Sequence

from . import __path__ as package_folders
from .errors import InstallationError

BUILD = "build the catkin workspace (./robocop setup, or catkin_make) and source its setup.bash"


def file_name(name: str) -> str:
    """The file of a library, as CMakeLists.txt names it."""
    return f"libaro_robocop_goto_as_{name}.so"


def find(name: str, folders: Optional[Sequence[str]] = None) -> str:
    """A library's path: CMake puts it into the Python package, in devel space and in install space.

    In devel space that folder and the sources are both in the package's __path__. InstallationError when it is missing.
    """
    folders = list(package_folders if folders is None else folders)
    for folder in folders:
        path = os.path.join(folder, file_name(name))
        if os.path.isfile(path):
            return path
    raise InstallationError(f"{file_name(name)} is in none of {', '.join(folders)}: {BUILD}")


def load(name: str, version: int, path: Optional[str] = None) -> ctypes.PyDLL:
    """A library, which holds the GIL during its calls, so that one thread at a time runs in it.

    InstallationError when it is missing, can't be loaded, or was built from other sources: their version differs.
    """
    path = path or find(name)
    try:
        library = ctypes.PyDLL(path)
        built = getattr(library, f"aro_{name}_version")()
    except (OSError, AttributeError) as error:
        raise InstallationError(f"{path} can't be used ({error}): {BUILD}") from error
    if built != version:
        raise InstallationError(f"{path} has version {built}, these sources need version {version}: {BUILD}")
    return library
