"""The compiled library: caster.c casts rays, and sensors/lidar.c makes ranges with noise of exact distances."""

import ctypes
import functools
from typing import Any

from .. import compiled

REFUSED = {1: "robots: expected numbers of robots in the scene", 2: "poses: expected finite numbers"}  # as in caster.c


def _require_ok(status: Any, _function: object, _arguments: object) -> Any:
    if status:
        raise ValueError(REFUSED[status])
    return status


@functools.lru_cache(maxsize=None)
def load() -> ctypes.PyDLL:
    """The library. It holds the GIL during a call, so two threads cannot use the marks of tiles at once.

    InstallationError when it is missing, can't be loaded, or was built from other sources.
    """
    library = compiled.load("caster", "raycast/caster.c")
    pointer, integer, unsigned = ctypes.c_void_p, ctypes.c_int64, ctypes.c_uint64
    library.aro_cast.restype, library.aro_cast.errcheck = ctypes.c_int, _require_ok
    library.aro_cast.argtypes = [pointer, pointer, integer, pointer, ctypes.c_double, pointer]
    library.aro_normals.restype = library.aro_measure.restype = None
    library.aro_normals.argtypes = [unsigned, unsigned, unsigned, integer, pointer]
    library.aro_measure.argtypes = [pointer, integer, pointer, pointer, pointer]
    return library
