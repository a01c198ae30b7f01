"""Turns ./robocop into another program: installs the packages that the program needs, then becomes the program.

It calls the shell script `robocop` back: `_set_up PART...` installs, and `_environment DEVEL` prints the environment of
a workspace.
"""

import fcntl
import os
import shlex
import signal
import subprocess
import sys
from pathlib import Path
from typing import Any, Dict, List, Mapping, NoReturn, Optional
from xml.etree import ElementTree

from ..names import PACKAGE
from ..process import file_lock, signals
from ..process.start import BY_ROBOCOP
from . import doctor

ROOT = Path(__file__).resolve().parents[3]
SCRIPT = str(ROOT / "robocop")
# The launch files whose arguments a command takes.
RUN, SIM, REPLAY = (ROOT / "launch" / f"{name}.launch" for name in ("robocop_goto_as", "robocop_sim", "replay"))
NOT_EXECUTABLE, NOT_FOUND = 126, 127  # exit statuses, as of a shell


def say(text: str) -> None:
    """Print a message to standard error."""
    print(f"robocop: {text}", file=sys.stderr, flush=True)


def refuse(text: str) -> NoReturn:
    """End with a message and exit status 1."""
    raise SystemExit(f"robocop: {text}")


def is_dry_run() -> bool:
    """Return whether nothing may be installed, built or started."""
    return bool(os.environ.get("ROBOCOP_DRY_RUN"))


def state() -> Path:
    """The folder of everything that is built."""
    return Path(os.environ["ROBOCOP_STATE"])


def version() -> str:
    """Name and version of the package, and the commit of a checkout."""
    describe = ["git", "-C", str(ROOT), "describe", "--always", "--dirty", "--exclude", "*"]
    try:
        commit = subprocess.run(describe, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True).stdout.strip()
    except OSError:
        commit = ""
    number = ElementTree.parse(ROOT / "package.xml").findtext("version")
    return f"{PACKAGE} {number}" + (f" (commit {commit})" if commit else "")


def module(name: str, *arguments: str) -> List[str]:
    """The command line of a Python module in the virtual environment."""
    return [str(state() / "venv" / "bin" / "python"), "-m", name, *arguments]


def set_up(*parts: str) -> bool:
    """Install and build what is missing, also for these parts of install/deb-packages/; return whether it succeeded."""
    ros = "" if is_dry_run() else doctor.ros_in_opt()
    missing = doctor.missing_modules() if ros else ""
    if missing:
        say(f"ROS is at {ros}, but these Python modules are missing: {missing} (in ros-noetic-* or python3-* packages)")
        return False
    with signals.Deferred(signal.SIGINT):  # Ctrl-C also ends the set-up, which is waited for
        return subprocess.call([SCRIPT, "_set_up", *parts]) == 0


def need(*parts: str) -> None:
    """Like set_up, but end this program on a failure, which has been reported."""
    if not set_up(*parts):
        sys.exit(1)
    if not is_dry_run():
        _keep_workspace()


def _keep_workspace() -> None:
    """Choose the newest workspace; no later set-up removes it before this program, and what it becomes, has ended."""
    workspace = (state() / "workspace").resolve()
    stamp = workspace / "built-from"
    try:
        lock = os.open(str(stamp), os.O_RDONLY)
        file_lock.lock(lock, fcntl.LOCK_SH)
        os.stat(stamp)
    except FileNotFoundError:
        refuse(f"{workspace} was replaced at this moment; try again")
    os.set_inheritable(lock, True)
    os.environ["ROBOCOP_WS"] = f"{workspace}/devel"


def start(*command: str) -> NoReturn:
    """Become a program in the workspace; in a dry run, show it."""
    if is_dry_run():
        for name in ("ROS_HOSTNAME", "ROS_IP", "ROS_MASTER_URI"):
            if name in os.environ:
                print(f"{name}={os.environ[name]}")
        become(*command)
    become(*command, environment=workspace_environment())


def workspace_environment() -> Dict[bytes, bytes]:
    """This process's environment, with the additions of the workspace's set-up files; a failure ends this program."""
    done = subprocess.run([SCRIPT, "_environment", os.environ["ROBOCOP_WS"]], stdout=subprocess.PIPE)
    if done.returncode != 0:
        sys.exit(1)  # it has said why
    lines = (line.partition(b"=") for line in done.stdout.split(b"\0") if line)
    return {name: value for name, _, value in lines}


def start_script(name: str, *arguments: str) -> NoReturn:
    """Become one of the package's scripts."""
    # Ctrl-C while Python starts would print a traceback; the scripts unblock it before their imports.
    signal.pthread_sigmask(signal.SIG_BLOCK, [signal.SIGINT])
    os.environ[BY_ROBOCOP] = "true"
    start(f"{os.environ['ROBOCOP_WS']}/lib/{PACKAGE}/{name}", *arguments)


def start_launcher(*arguments: str) -> NoReturn:
    """Become roslaunch, but with an exit status that reports how the simulator ended."""
    signal.pthread_sigmask(signal.SIG_BLOCK, [signal.SIGINT])  # as above
    start(str(state() / "venv" / "bin" / "python"), f"{ROOT}/launch/robocop_launch.py", *arguments)


def become(*command: str, environment: Optional[Mapping[Any, Any]] = None) -> NoReturn:
    """Replace this process by a program, in this environment or its own; in a dry run, print it."""
    if is_dry_run():
        print(shlex.join(command))
        sys.exit()
    sys.stdout.flush()
    try:
        os.execvpe(command[0], command, os.environ if environment is None else environment)
    except OSError as error:
        say(f"{command[0]}: {error.strerror}")
        sys.exit(NOT_FOUND if isinstance(error, FileNotFoundError) else NOT_EXECUTABLE)
