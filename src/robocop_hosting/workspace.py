"""Catkin workspaces that are built from copies of packages, with the environment to run them in."""

import contextlib
import fcntl
import functools
import os
import re
import shutil
import sys
import tempfile
import zlib
from pathlib import Path
from typing import IO, Callable, Dict, Iterator, Mapping, Sequence, Tuple

from aro_robocop_goto_as.errors import InstallationError

from . import child, file_lock, tree
from .errors import HostingError

Environment = Dict[str, str]

# Variables that catkin's setup files extend, one workspace on top of another.
CHAINED = ("CMAKE_PREFIX_PATH", "LD_LIBRARY_PATH", "PKG_CONFIG_PATH", "PYTHONPATH", "ROS_PACKAGE_PATH")
COMPAT = ("aro_sim", "gazebo_msgs", "ros_numpy", "xacro")  # in place of packages of these names in a workspace
LEFT_OUT = (".git", "__pycache__", "build", "devel", ".robocop")
NOT_COPIED = shutil.ignore_patterns(*LEFT_OUT, "*.pyc")
PLAIN = re.compile(r"[A-Za-z0-9/._-]+")  # a path as in_place.cmake takes it
LANGUAGES = ("cpp", "eus", "lisp", "nodejs", "py")
CPP = (".cc", ".cpp", ".cxx")
# As for Noetic's Boost, with _1, _2, ... of boost::bind() outside of its namespace
CXX_FLAGS = "-DBOOST_BIND_GLOBAL_PLACEHOLDERS -include boost/bind.hpp"
IN_PLACE = Path(__file__).resolve().with_name("in_place.cmake")
LOG_LINES = 25  # of a failed build's log that are shown
MAX_SHOWN = 4_000  # characters of them
MAX_READ = 200_000  # bytes of a log's end
# By CMake, Python, GCC and make.
FIRST_ERROR = re.compile(r"^(CMake Error|Traceback|.*\berror: |make.*\*\*\*)", re.MULTILINE)


def run(command: Sequence[str], environment: Environment, output: "IO[bytes]", errors: "IO[bytes]") -> int:
    """Run a command; its exit status."""
    process = child.start(command, environment=environment, stdout=output, stderr=errors)
    try:
        return process.wait()
    finally:
        child.end(process, None, 0.0)


def output_of(command: Sequence[str], environment: Environment) -> Tuple[int, bytes, str]:
    """Exit status, output and errors of a command."""
    with tempfile.TemporaryFile() as output, tempfile.TemporaryFile() as errors:
        status = run(command, environment, output, errors)
        output.seek(0)
        errors.seek(0)
        return status, output.read(), errors.read().decode(errors="replace")


def workspace_name(path: Path) -> str:
    """The name of the folder in which a path's package is built: make, CMake and genmsg don't accept every name."""
    return f"package-{zlib.crc32(os.fsencode(path)):08x}"


def base_environment() -> Environment:
    """This process's environment without any workspace, and with the ROS of ROBOCOP_BASE_SETUP, if that is set."""
    environment = {name: value for name, value in os.environ.items() if name not in CHAINED}
    environment["PYTHONDONTWRITEBYTECODE"] = "1"
    setup = environment.get("ROBOCOP_BASE_SETUP")
    return sourced(Path(setup), environment) if setup else environment


def sourced(setup: Path, environment: Environment) -> Environment:
    """The environment after bash has sourced a setup file."""
    status, output, errors = output_of(["bash", "-c", '. "$0" >/dev/null && env -0', str(setup)], environment)
    if status != 0:
        raise HostingError(f"{setup}: {errors.strip()[-MAX_SHOWN:]}")
    pairs = [entry.partition("=") for entry in os.fsdecode(output).split("\0") if entry]
    return {name: value for name, _, value in pairs}


def copy_sources(sources: Mapping[str, Path], folder: Path) -> None:
    """Replace the sources of the workspace at `folder` by copies of packages (name -> folder).

    HostingError if they can't be copied; links that lead nowhere are left out.
    """
    source = folder / "src"
    shutil.rmtree(source, ignore_errors=True)
    source.mkdir(parents=True)
    for name, path in sources.items():
        try:
            shutil.copytree(path, source / name, ignore=NOT_COPIED, ignore_dangling_symlinks=True)
        except OSError as error:  # shutil.Error is one
            first = error.args[0][0][-1] if isinstance(error, shutil.Error) else error  # of one for each file
            raise HostingError(f"{path}: can't be copied: {first}") from error
        for inner, _, _ in tree.walk(source / name):
            os.chmod(inner, os.stat(inner).st_mode | 0o700)  # a copy of a read-only folder can't be removed


def build(sources: Mapping[str, Path], folder: Path, underlay: Environment) -> Environment:
    """Build copies of packages (name -> folder) in a workspace at `folder`; return the environment with it on top.

    An earlier build is reused. HostingError shows the end of the log of a build that failed.
    """
    copy_sources(sources, folder)
    return make(folder, " and ".join(sources), underlay)


def build_in_place(sources: Mapping[str, Path], folder: Path, underlay: Environment) -> Environment:
    """As build(), but of the packages themselves, C++ nodes as well, so that messages name their author's files.

    Nothing is written into their folders.
    """
    source = folder / "src"
    shutil.rmtree(source, ignore_errors=True)
    source.mkdir(parents=True)
    for name, path in sources.items():
        (source / name).symlink_to(path)
    files = (Path(name) for path in sources.values() for _, _, names in tree.walk(path) for name in names)
    languages, definitions = ["py"], [f"-DCMAKE_PROJECT_Project_INCLUDE={IN_PLACE}"]
    if any(file.suffix in CPP for file in files):
        languages.append("cpp")
        definitions.append(f"-DCMAKE_CXX_FLAGS={CXX_FLAGS}")
    make(folder, " and ".join(sources), underlay, languages, definitions)
    # Where ROS looks for packages: at their own paths, too
    found = (str(path if PLAIN.fullmatch(str(path)) else source / name) for name, path in sources.items())
    (folder / "devel" / ".catkin").write_text(";".join(found))
    return sourced(folder / "devel" / "setup.bash", underlay)


def make(
    folder: Path,
    names: str,
    underlay: Environment,
    languages: Sequence[str] = ("py",),
    definitions: Sequence[str] = (),
) -> Environment:
    """As build(), but the sources are already in place; messages are generated for these languages only.

    definitions: -DNAME=VALUE, for CMake.
    """
    log = folder / "build.log"
    python = f"-DPYTHON_EXECUTABLE={sys.executable}"
    with open(log, "w+b") as output:
        status = run(
            ["catkin_make", "-C", str(folder), python, "-DCATKIN_ENABLE_TESTING=OFF", *definitions],
            {**underlay, "ROS_LANG_DISABLE": ":".join(f"gen{it}" for it in LANGUAGES if it not in languages)},
            output,
            output,
        )
        output.seek(max(0, output.seek(0, os.SEEK_END) - MAX_READ))
        text = output.read().decode(errors="replace") if status != 0 else ""
    if status != 0:
        raise HostingError(f"{names} can't be built:\n{error_of(text, folder)}\nfull log: {log}")
    return sourced(folder / "devel" / "setup.bash", underlay)


def error_of(log: str, folder: Path) -> str:
    """A failed build's log from its first error on, or its end if it names no error; paths are relative to `folder`."""
    log = log.replace(f"{folder}/", "")
    error = FIRST_ERROR.search(log)
    lines = log[error.start() :].splitlines()[:LOG_LINES] if error else log.splitlines()[-LOG_LINES:]
    shown = "\n".join(lines)
    return shown[:MAX_SHOWN] if error else shown[-MAX_SHOWN:]


def build_once(folder: Path, underlay: Environment, build_workspace: Callable[[], Environment]) -> Environment:
    """The environment of the workspace at `folder`, which is built unless that has been done."""
    stamp = folder / "built-at"
    with exclusive(folder):
        if stamp.is_file() and stamp.read_text() == str(folder):  # catkin writes absolute paths into what it builds
            return sourced(folder / "devel" / "setup.bash", underlay)
        stamp.unlink(missing_ok=True)
        environment = build_workspace()
        stamp.write_text(str(folder))
    return environment


def folder_for(parent: Path, *sources: Path) -> Path:
    """The folder below `parent` for a build of these folders: another one after any change of a file in them.

    So no build takes an older one away from what runs out of it.
    """
    checksum = 0
    for source in sources:
        for path in sorted(source.rglob("*")):
            if path.is_file() and path.suffix != ".pyc":
                checksum = zlib.crc32(os.fsencode(path.relative_to(source.parent)) + path.read_bytes(), checksum)
    return parent / f"{checksum:08x}"


@contextlib.contextmanager
def exclusive(folder: Path) -> Iterator[None]:
    """Wait until no other process uses this folder, and lock it; the lock is a file beside the folder."""
    folder.parent.mkdir(parents=True, exist_ok=True)
    with open(folder.parent / f"{folder.name}.lock", "wb") as lock:
        if not file_lock.lock(lock.fileno(), fcntl.LOCK_EX | fcntl.LOCK_NB):
            print(f"waiting for another process that uses {folder}", file=sys.stderr, flush=True)
            fcntl.flock(lock, fcntl.LOCK_EX)
        yield


@functools.lru_cache(maxsize=None)  # the same folder all the time, even if the sources change meanwhile
def compat_folder(share: Path, state: Path) -> Path:
    """The workspace below `state`/compat of the packages in `share`/compat, a folder of this package."""
    return folder_for(state / "compat", share / "compat")


def compat_environment(share: Path, state: Path) -> Environment:
    """The environment with the lab's aro_sim and Gazebo's message types, on which hosted packages are built."""
    folder, sources = compat_folder(share, state), {name: share / "compat" / name for name in COMPAT}
    underlay = base_environment()
    return build_once(folder, underlay, lambda: build(sources, folder, underlay))


def places() -> Tuple[Path, Path]:
    """The folder of everything that is built, and this package's folder; InstallationError without ./robocop."""
    try:
        return Path(os.environ["ROBOCOP_STATE"]), Path(os.environ["ROBOCOP_SHARE"])
    except KeyError as error:
        raise InstallationError(f"{error.args[0]} is not set; use ./robocop COMMAND instead of rosrun") from error
