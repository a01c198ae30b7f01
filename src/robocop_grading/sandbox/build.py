"""Builds a submission's package in the sandbox: a build runs code of its author."""

import os
import shutil
import stat
import subprocess
from pathlib import Path
from typing import IO, Dict, Iterable, Iterator, Mapping, Optional, Sequence

from robocop_hosting import child, tree
from robocop_hosting.errors import HostingError
from robocop_hosting.package import MAX_NAMED
from robocop_hosting.scripts import files_below
from robocop_hosting.workspace import CHAINED, Environment, Run, copy_sources, make, run_plain

from ..errors import GradingError
from ..files.archives import is_ungraded
from .bubblewrap import OWN_ENVIRONMENT, Sandbox, change_owner, user
from .guard import Guard
from .limits import BUILD_TIMEOUT, MAX_BUILD_CPU_TIME, MAX_SOURCE, MB

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
    wrapped = sandbox.command_inside

    def run(command: Sequence[str], environment: Environment, output: "IO[bytes]", errors: "IO[bytes]") -> int:
        name = Path(command[0]).name
        visible = {**public(environment), "HOME": "/tmp", "ROS_HOME": "/tmp", "ROS_LOG_DIR": "/tmp"}
        change_owner(folder, user())
        inside = wrapped(command, visible, reads, folder, is_build=True)
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
    says why the build failed, and names links that lead elsewhere. What an unfinished build has left is removed.
    """
    unfinished = folder.with_name(f"{folder.name}.unfinished")  # beside it: what is in it, a build may change
    if unfinished.exists():
        tree.remove(folder)
    folder.parent.mkdir(parents=True, exist_ok=True)
    unfinished.touch()
    sizes: Dict[str, int] = {}  # bytes of each file
    copied = 0  # bytes
    names = " and ".join(sources)

    def copy(path: str, target: str) -> None:
        nonlocal copied
        status = os.stat(path)
        if not stat.S_ISREG(status.st_mode):
            raise GradingError(f"{path}: expected an ordinary file")
        size = status.st_size
        if is_ungraded(path, size):
            return
        sizes[path] = size
        copied += size
        if copied > MAX_SOURCE:
            largest = max(sizes, key=lambda it: sizes[it])
            raise GradingError(
                f"{names}: expected packages of less than {MAX_SOURCE // MB} MB; the largest file in it is "
                f"{largest} with {sizes[largest] / MB:.1f} MB"
            )
        shutil.copy2(path, target)

    copy_sources(sources, folder, sandbox is None, copy)
    links = [] if sandbox is None else list(_links_elsewhere(folder / "src", sources))
    try:
        environment = make(folder, names, underlay, runner_in(sandbox, folder, reads))
    except HostingError as error:
        links = [link for link in links if Path(link.partition(" -> ")[0]).name in str(error)]
        if not links:
            raise
        told = "links that lead out of the package are not followed: put the files themselves in their places"
        raise HostingError(f"{', '.join(links[:MAX_NAMED])}: {told}\n{error}") from error
    unfinished.unlink()
    return environment


def _links_elsewhere(copies: Path, names: Iterable[str]) -> Iterator[str]:
    """The links in copies of packages that lead out of all copies, each with where it leads."""
    inside = os.path.realpath(copies)
    for name in names:
        top = copies / name
        for path in files_below(top):
            if path.is_symlink() and inside not in map(str, Path(os.path.realpath(path)).parents):
                yield f"{path.relative_to(top)} -> {os.readlink(path)}"
