"""Building somebody's package is running their code: done in the cage, with the guard watching."""

import os
import shutil
import subprocess
import tempfile
from pathlib import Path
from typing import IO, Mapping, Optional, Sequence, Tuple

from ..errors import GradingError
from ..hosting.workspace import CHAINED, Environment, Run, copy_sources, make, plainly
from .guard import Guard
from .sandbox import OWN_ENVIRONMENT, Cage, hand_over, user

MOST_SOURCE = 64 * 1024 ** 2  # bytes of a package
BUILD_TIME = 180.0  # [s, wall]
SHOWN = {*CHAINED, "LANG", "LC_ALL", "PATH", "TERM"}  # of this process's environment: the rest may be private
SHOWN_PREFIXES = ("ROS_", "ROSLISP_", "PYTHON")


def shown(environment: Mapping[str, str]) -> Environment:
    """What other people's code gets to see of an environment."""
    return {name: value for name, value in environment.items()
            if (name in SHOWN or name.startswith(SHOWN_PREFIXES)) and name != "ROS_MASTER_URI"}


def run_in(cage: Optional[Cage], folder: Path, reads: Sequence[Path], patience: float = BUILD_TIME) -> Run:
    """How commands of a build are run that may write to `folder` alone; GradingError when one takes too much."""
    if cage is None:
        return plainly
    walls = cage.around_build

    def run(command: Sequence[str], environment: Environment, output: "IO[bytes]", errors: "IO[bytes]") -> int:
        seen = {**shown(environment), "HOME": "/tmp", "ROS_HOME": "/tmp", "ROS_LOG_DIR": "/tmp"}
        hand_over(folder, user())
        process = subprocess.Popen(walls(command, seen, reads, folder), env=OWN_ENVIRONMENT,
                                   stdin=subprocess.DEVNULL, stdout=output, stderr=errors, start_new_session=True)
        guard = Guard(process.pid, folder)
        try:
            status = process.wait(patience)
        except subprocess.TimeoutExpired as error:
            raise GradingError(f"{command[0]} took longer than {patience:g} s") from error
        finally:
            process.kill()
            process.wait()
            guard.stop()
            hand_over(folder, 0)
        if guard.reason:
            raise GradingError(f"{command[0]} was ended: {guard.reason}")
        return status

    return run


def build(name: str, source: Path, folder: Path, underlay: Environment, reads: Sequence[Path],
          cage: Optional[Cage]) -> Environment:
    """A copy of the package at `source`, built in a workspace at `folder`; the environment with it on top.

    Links are copied as links, so that none leads to what its author can't read. GradingError says why it failed.
    """
    copied = 0

    def copy(path: str, target: str) -> None:
        nonlocal copied
        copied += os.stat(path).st_size
        if copied > MOST_SOURCE:
            raise GradingError(f"{source}: expected a package of less than {MOST_SOURCE // 1024 ** 2} MB")
        shutil.copy2(path, target)

    try:
        copy_sources({name: source}, folder, cage is None, copy)
    except (OSError, shutil.Error) as error:
        raise GradingError(f"{source}: can't be copied: {error}") from error
    return make(folder, name, underlay, run_in(cage, folder, reads))


def output_of(run: Run, command: Sequence[str], environment: Environment, most: int) -> Tuple[int, str, str]:
    """Exit status, output and errors of a command, each of them cut at `most` bytes."""
    with tempfile.TemporaryFile() as output, tempfile.TemporaryFile() as errors:
        status = run(command, environment, output, errors)
        output.seek(0)
        errors.seek(0)
        return status, output.read(most).decode(errors="replace"), errors.read(most).decode(errors="replace")
