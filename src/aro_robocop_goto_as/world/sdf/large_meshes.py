"""Read mesh files; large ones in a process of their own, with a limit on its time, and only once.

Their triangles are kept in ROS's home, under the hash of the file, because some files take minutes.
"""

import hashlib
import logging
import os
import resource
import signal
import subprocess
import sys
import tempfile
import time
from typing import Optional

import numpy as np
import rospkg

from ...errors import WorldError
from ...reading import reading
from .meshes import read_triangles

LARGE = 1_000_000  # bytes of a file; smaller ones take less than half a second
TIME_LIMIT = 600  # [s] of processor time for one file
PERIOD = 10.0  # [s] between two messages that a file is still being read
KEPT = 20  # files in the folder; those that were not used for longest are deleted
FORMAT = "1"  # a part of the hash; another one makes what earlier versions kept unused

_log = logging.getLogger(__name__)


def load_triangles(path: str) -> np.ndarray:
    """The triangles (n, 3, 3) [m] of a mesh file, as read_triangles; WorldError also beyond TIME_LIMIT."""
    with reading(path, WorldError, "a mesh"):
        size = os.path.getsize(path)
        if size < LARGE:
            return read_triangles(path)
        folder = os.path.join(rospkg.get_ros_home(), "robocop_meshes")
        digest = hashlib.sha256((FORMAT + os.path.splitext(path)[1].lower()).encode())
        with open(path, "rb") as file:
            digest.update(file.read())
        kept = os.path.join(folder, digest.hexdigest() + ".npy")
        triangles = _kept_triangles(kept)
        if triangles is None:
            _log.warning("reading %s, %.1f MB, which may take minutes the first time", path, size / 1e6)
            triangles = _read_in_child(path)
            _keep(triangles, kept)
        return triangles


def _kept_triangles(kept: str) -> Optional[np.ndarray]:
    """What was kept, or None if there is nothing or it is damaged."""
    try:
        triangles = np.load(kept, allow_pickle=False)
        os.utime(kept)
    except (OSError, ValueError, EOFError):
        return None
    is_whole = triangles.ndim == 3 and triangles.shape[1:] == (3, 3) and triangles.dtype == float
    return triangles if is_whole else None


def _keep(triangles: np.ndarray, kept: str) -> None:
    """Write triangles to a file and delete the oldest ones; where that is not possible, the next start reads again."""
    folder = os.path.dirname(kept)
    try:
        os.makedirs(folder, exist_ok=True)
        with tempfile.NamedTemporaryFile(dir=folder, delete=False) as part:
            np.save(part, triangles)
        os.replace(part.name, kept)
        files = sorted((os.path.join(folder, name) for name in os.listdir(folder)), key=os.path.getmtime)
        for old in files[:-KEPT]:
            os.remove(old)
    except OSError as exc:
        _log.warning("%s: can't keep the mesh for the next start: %s", folder, exc.strerror)


def _read_in_child(path: str) -> np.ndarray:
    """Read a file in a process of its own, which writes the triangles, or its error, to an open file."""
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join(filter(None, sys.path))}
    command = [sys.executable, "-m", __name__, path, str(TIME_LIMIT)]
    with tempfile.TemporaryFile() as result:
        child = subprocess.Popen(command, stdout=result, stderr=subprocess.PIPE, env=environment)
        errors: Optional[bytes] = None
        started = time.monotonic()
        try:
            while errors is None:
                try:
                    _, errors = child.communicate(timeout=PERIOD)
                except subprocess.TimeoutExpired:
                    _log.warning("still reading %s after %.0f s", path, time.monotonic() - started)
        finally:
            child.kill()
            child.wait()
        if child.returncode == -signal.SIGXCPU:
            raise WorldError(
                f"{path}: not read within {TIME_LIMIT} s of processor time; expected a simpler mesh, or .stl"
            )
        if child.returncode != 0:
            error = errors.decode("utf-8", "replace").strip().rpartition("\n")[2]
            raise WorldError(error or f"{path}: reading it was ended by signal {-child.returncode}")
        result.seek(0)
        return np.asarray(np.load(result, allow_pickle=False))


def _main() -> None:
    """The child: arguments are the file and the limit."""
    path, limit = sys.argv[1], int(sys.argv[2])
    resource.setrlimit(resource.RLIMIT_CPU, (limit, limit + 1))
    try:
        np.save(sys.stdout.buffer, read_triangles(path))
    except WorldError as exc:
        sys.exit(str(exc))


if __name__ == "__main__":
    _main()
