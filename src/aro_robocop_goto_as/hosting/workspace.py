"""Packages' sources -> a catkin workspace of their own, built from copies, with the environment to run it in."""

import os
import shutil
import subprocess
import sys
from pathlib import Path
from typing import Dict, Mapping

from ..errors import HostingError

Environment = Dict[str, str]

# What catkin's set-up files extend, one workspace upon the other.
CHAINED = ("CMAKE_PREFIX_PATH", "LD_LIBRARY_PATH", "PKG_CONFIG_PATH", "PYTHONPATH", "ROS_PACKAGE_PATH")
NOT_COPIED = shutil.ignore_patterns(".git", "__pycache__", "*.pyc", "build", "devel", ".robocop")
LOG_LINES = 25  # of a failed build's log that are shown


def base_environment() -> Environment:
    """This process's environment without any workspace; ROBOCOP_BASE_SETUP leads to a ROS that is not the system's."""
    environment = {name: value for name, value in os.environ.items() if name not in CHAINED}
    environment["PYTHONDONTWRITEBYTECODE"] = "1"
    setup = environment.get("ROBOCOP_BASE_SETUP")
    return sourced(Path(setup), environment) if setup else environment


def sourced(setup: Path, environment: Environment) -> Environment:
    """The environment after a set-up file of bash."""
    done = subprocess.run(["bash", "-c", '. "$0" >/dev/null && env -0', str(setup)], env=environment,
                          capture_output=True)
    if done.returncode != 0:
        raise HostingError(f"{setup}: {done.stderr.decode(errors='replace').strip()}")
    pairs = [entry.partition("=") for entry in done.stdout.decode(errors="surrogateescape").split("\0") if entry]
    return {name: value for name, _, value in pairs}


def build(sources: Mapping[str, Path], folder: Path, underlay: Environment) -> Environment:
    """Build copies of packages (name -> folder) in a workspace at `folder`; the environment with it on top.

    What is there of an earlier build is used again. HostingError shows the end of the log of a build that failed.
    """
    source = folder / "src"
    shutil.rmtree(source, ignore_errors=True)
    source.mkdir(parents=True)
    for name, path in sources.items():
        shutil.copytree(path, source / name, ignore=NOT_COPIED)
    log = folder / "build.log"
    with open(log, "wb") as output:
        status = subprocess.call(
            ["catkin_make", "-C", str(folder), f"-DPYTHON_EXECUTABLE={sys.executable}", "-DCATKIN_ENABLE_TESTING=OFF"],
            env={**underlay, "ROS_LANG_DISABLE": "gencpp:geneus:genlisp:gennodejs"}, stdin=subprocess.DEVNULL,
            stdout=output, stderr=subprocess.STDOUT)
    if status != 0:
        last = "\n".join(log.read_text(errors="replace").splitlines()[-LOG_LINES:])
        raise HostingError(f"{' and '.join(sources)} can't be built:\n{last}\nall of it: {log}")
    return sourced(folder / "devel" / "setup.bash", underlay)
