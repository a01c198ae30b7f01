"""Packages' sources -> a catkin workspace of their own, built from copies, with the environment to run it in."""

import contextlib
import fcntl
import os
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import IO, Callable, Dict, Iterator, Mapping, Sequence

from ..errors import HostingError

Environment = Dict[str, str]
Run = Callable[[Sequence[str], Environment, "IO[bytes]", "IO[bytes]"], int]  # ..., output, errors -> exit status

# What catkin's set-up files extend, one workspace upon the other.
CHAINED = ("CMAKE_PREFIX_PATH", "LD_LIBRARY_PATH", "PKG_CONFIG_PATH", "PYTHONPATH", "ROS_PACKAGE_PATH")
NOT_COPIED = shutil.ignore_patterns(".git", "__pycache__", "*.pyc", "build", "devel", ".robocop")
LOG_LINES = 25  # of a failed build's log that are shown


def plainly(command: Sequence[str], environment: Environment, output: "IO[bytes]", errors: "IO[bytes]") -> int:
    """Run a command with nothing around it."""
    return subprocess.call(command, env=environment, stdin=subprocess.DEVNULL, stdout=output, stderr=errors)


def base_environment() -> Environment:
    """This process's environment without any workspace; ROBOCOP_BASE_SETUP leads to a ROS that is not the system's."""
    environment = {name: value for name, value in os.environ.items() if name not in CHAINED}
    environment["PYTHONDONTWRITEBYTECODE"] = "1"
    setup = environment.get("ROBOCOP_BASE_SETUP")
    return sourced(Path(setup), environment) if setup else environment


def sourced(setup: Path, environment: Environment, run: Run = plainly) -> Environment:
    """The environment after a set-up file of bash."""
    with tempfile.TemporaryFile() as output, tempfile.TemporaryFile() as errors:
        status = run(["bash", "-c", '. "$0" >/dev/null && env -0', str(setup)], environment, output, errors)
        output.seek(0)
        errors.seek(0)
        if status != 0:
            raise HostingError(f"{setup}: {errors.read().decode(errors='replace').strip()}")
        text = output.read().decode(errors="surrogateescape")
    pairs = [entry.partition("=") for entry in text.split("\0") if entry]
    return {name: value for name, _, value in pairs}


def copy_sources(sources: Mapping[str, Path], folder: Path, follow_links: bool = True,
                 copy: Callable[[str, str], object] = shutil.copy2) -> None:
    """Copies of packages (name -> folder) into the workspace at `folder`, in place of those that are there."""
    source = folder / "src"
    shutil.rmtree(source, ignore_errors=True)
    source.mkdir(parents=True)
    for name, path in sources.items():
        shutil.copytree(path, source / name, symlinks=not follow_links, ignore=NOT_COPIED, copy_function=copy)
        for place, _, _ in os.walk(source / name):
            os.chmod(place, os.stat(place).st_mode | 0o700)  # else a copy of what can only be read can't be removed


def build(sources: Mapping[str, Path], folder: Path, underlay: Environment) -> Environment:
    """Build copies of packages (name -> folder) in a workspace at `folder`; the environment with it on top.

    What is there of an earlier build is used again. HostingError shows the end of the log of a build that failed.
    """
    copy_sources(sources, folder)
    return make(folder, " and ".join(sources), underlay)


def make(folder: Path, names: str, underlay: Environment, run: Run = plainly) -> Environment:
    """The same for a workspace that has its sources."""
    log = folder / "build.log"
    log.unlink(missing_ok=True)  # a link there would be followed
    with open(log, "w+b") as output:
        status = run(
            ["catkin_make", "-C", str(folder), f"-DPYTHON_EXECUTABLE={sys.executable}", "-DCATKIN_ENABLE_TESTING=OFF"],
            {**underlay, "ROS_LANG_DISABLE": "gencpp:geneus:genlisp:gennodejs"}, output, output)
        output.seek(0)
        last = b"".join(output.readlines()[-LOG_LINES:]).decode(errors="replace") if status != 0 else ""
    if status != 0:
        raise HostingError(f"{names} can't be built:\n{last}\nall of it: {log}")
    return sourced(folder / "devel" / "setup.bash", underlay, run)


@contextlib.contextmanager
def alone(folder: Path) -> Iterator[None]:
    """Nobody else's process is in here for this folder at the same time; the lock is a file beside it."""
    folder.parent.mkdir(parents=True, exist_ok=True)
    with open(folder.parent / f"{folder.name}.lock", "wb") as lock:
        try:
            fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            print(f"waiting for another process that is at work on {folder}", file=sys.stderr, flush=True)
            fcntl.flock(lock, fcntl.LOCK_EX)
        yield
