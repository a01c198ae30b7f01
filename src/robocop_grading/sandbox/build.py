"""Builds a submission's package in the sandbox: a build runs code of its author."""

import os
import shutil
import subprocess
from pathlib import Path
from typing import IO, Mapping, Optional, Sequence

from aro_robocop_goto_as.errors import GradingError
from aro_robocop_goto_as.process import child

from ..builds.workspace import CHAINED, Environment, Run, copy_sources, make, run_plain
from .bubblewrap import OWN_ENVIRONMENT, Sandbox, change_owner, user
from .guard import Guard
from .limits import BUILD_TIMEOUT, MAX_BUILD_CPU_TIME, MAX_SOURCE

PUBLIC = {*CHAINED, "LANG", "LC_ALL", "PATH", "TERM"}  # variables passed on; the others may be private
PUBLIC_PREFIXES = ("ROS_", "ROSLISP_", "PYTHON")


def public(environment: Mapping[str, str]) -> Environment:
    """The variables of an environment that a submission may see."""
    return {
        name: value
        for name, value in environment.items()
        if (name in PUBLIC or name.startswith(PUBLIC_PREFIXES)) and name != "ROS_MASTER_URI"
    }


def runner_in(sandbox: Optional[Sandbox], folder: Path, reads: Sequence[Path]) -> Run:
    """Return a function that runs commands which may write to `folder` only.

    The function raises GradingError if a command exceeds its limit of processor time, memory or disk, or is not done
    in time.
    """
    if sandbox is None:
        return run_plain
    wrapped = sandbox.build_command

    def run(command: Sequence[str], environment: Environment, output: "IO[bytes]", errors: "IO[bytes]") -> int:
        name = Path(command[0]).name
        visible = {**public(environment), "HOME": "/tmp", "ROS_HOME": "/tmp", "ROS_LOG_DIR": "/tmp"}
        change_owner(folder, user())
        inside = wrapped(command, visible, reads, folder)
        process = child.start(inside, environment=OWN_ENVIRONMENT, stdout=output, stderr=errors)
        guard = Guard(process.pid, folder, processor_time=MAX_BUILD_CPU_TIME)
        try:
            status = process.wait(BUILD_TIMEOUT)
        except subprocess.TimeoutExpired as error:
            raise GradingError(f"{name} was not done within {BUILD_TIMEOUT:g} s") from error
        finally:
            child.end(process, None, 0.0)
            guard.stop()
            change_owner(folder, 0)
        if guard.reason:
            raise GradingError(f"{name} was ended: {guard.reason}")
        return status

    return run


def build(
    sources: Mapping[str, Path], folder: Path, underlay: Environment, reads: Sequence[Path], sandbox: Optional[Sandbox]
) -> Environment:
    """Build copies of packages (name -> folder) in a workspace at `folder`; the environment with it on top.

    In the sandbox links are copied as links: they must not lead to files that the author may not read. GradingError
    says why the build failed.
    """
    copied, names = 0, " and ".join(sources)

    def copy(path: str, target: str) -> None:
        nonlocal copied
        copied += os.stat(path).st_size
        if copied > MAX_SOURCE:
            raise GradingError(f"{names}: expected packages of less than {MAX_SOURCE // 1024**2} MB")
        shutil.copy2(path, target)

    try:
        copy_sources(sources, folder, sandbox is None, copy)
    except (OSError, shutil.Error) as error:
        raise GradingError(f"{names}: can't be copied: {error}") from error
    return make(folder, names, underlay, runner_in(sandbox, folder, reads))
