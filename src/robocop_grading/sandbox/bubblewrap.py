"""bubblewrap around a submission: a network of its own, a read-only system, a home directory in memory.

What runs in it has its own network namespace, loopback only, its own processes, and files in memory only: it sees
neither the grader's processes, bags and points nor other submissions. limits.py has the limits.
"""

import importlib.util
import os
import shlex
import shutil
import stat
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path
from typing import Iterable, List, Mapping, Optional, Sequence, Tuple

from aro_robocop_goto_as.names import ROOT
from robocop_hosting.workspace import CHAINED, Environment

from ..errors import GradingSetupError, UngradableError
from . import limits

FIRST_USER = 200_000  # uid and gid, above those in use; root would be exempt from process limits
USERS = 100_000
SOURCES = Path(__file__).resolve().parents[2]  # what prepares a submission
AGENT = SOURCES / "robocop_grading" / "agent"  # what runs in each node
HAND_IN = Path("/hand_in")  # where a submission is unpacked and built
SYSTEM = "/usr /bin /sbin /lib /lib32 /lib64 /opt /etc".split()
NAME = "student"  # of the user in the sandbox; libraries look up the current user, such as getpass and matplotlib
OWN_ENVIRONMENT = {"PATH": "/usr/bin:/bin"}  # of bwrap itself
PUBLIC = {*CHAINED, "LANG", "LC_ALL", "PATH", "TERM"}  # variables that are passed on; others may be private
PUBLIC_PREFIXES = ("ROS_", "ROSLISP_", "PYTHON")
# Without these an unprivileged user's sandbox could write to the tmpfs below / and /dev without limit, and to its
# oom_score_adj.
SEALED = ("--remount-ro", "/", "--remount-ro", "/dev", "--remount-ro", "/proc")
# What find prints. Left out are hidden files, which are no part of a hand-in, and compiled ones, which are not needed.
UNREADABLE = "( -name __pycache__ -o -name .* ) -prune -o ! -type l ! -readable -print -quit".split()
TRIAL_TIME = 600.0  # [s, wall] also on a busy machine
# Files that docker and podman make in every container.
CONTAINER_MARKS = ("/.dockerenv", "/run/.containerenv")
CONTAINER_OPTIONS = " ".join(f"--security-opt {it}=unconfined" for it in ("seccomp", "apparmor", "systempaths"))


@dataclass(frozen=True)
class Sandbox:
    """Builds the command lines that start something in the sandbox."""

    reads: Tuple[Path, ...]  # besides the system: what every submission needs, such as the virtual environment

    def command_inside(
        self, command: Sequence[str], environment: Mapping[str, str], reads: Sequence[Path], folder: Path
    ) -> List[str]:
        """Command line of a program that reads the system and `reads`, and writes to memory: to HAND_IN, and a little
        to /tmp, /dev/shm and `folder`, in which it starts.
        """
        wrap = [sys.executable, "-E", "-s", str(Path(__file__).with_name("syscall_filter.py"))]
        wrap += ["bwrap", "--die-with-parent", "--cap-drop", "ALL"]
        wrap += ["--unshare-net", "--unshare-pid", "--unshare-ipc", "--unshare-uts"]
        if os.geteuid() == 0:
            # For setpriv, which gives all of them up: SETPCAP is needed to empty the bounding set (util-linux 2.41).
            wrap += ["--cap-add", "CAP_SETUID", "--cap-add", "CAP_SETGID", "--cap-add", "CAP_SETPCAP"]
        # Shared memory made from /dev/zero belongs to nobody, see syscall_filter.py; /dev/full can be read likewise.
        wrap += ["--proc", "/proc", "--dev", "/dev", "--dev-bind", "/dev/full", "/dev/zero"]
        wrap += [*_writable(HAND_IN, limits.MAX_HAND_IN), *_writable(Path("/tmp")), *_writable(Path("/dev/shm"))]
        for parent in _parents([*map(Path, SYSTEM), *self.reads, *reads, folder]):
            wrap += ["--perms", "0755", "--dir", str(parent)]
        wrap += [*_mounts("--ro-bind-try", map(Path, SYSTEM)), *_mounts("--ro-bind", [*self.reads, *reads])]
        wrap += [*_hidden(Path("/etc")), *_accounts(environment.get("HOME", str(folder)))]
        wrap += [*_writable(folder), *SEALED, "--chdir", str(folder), "--"]
        return [*wrap, *_restrictions(environment), *command]


def public(environment: Mapping[str, str]) -> Environment:
    """The variables of an environment that a submission may see."""
    return {
        name: value
        for name, value in environment.items()
        if (name in PUBLIC or name.startswith(PUBLIC_PREFIXES)) and name != "ROS_MASTER_URI"
    }


def user() -> int:
    """The uid in the sandbox; when root starts it, one that only this process uses.

    The kernel counts processes per user, and concurrent runs must not use up each other's limit.
    """
    return FIRST_USER + os.getpid() % USERS if os.geteuid() == 0 else os.geteuid()


def group() -> int:
    """The gid in the sandbox."""
    return user() if os.geteuid() == 0 else os.getegid()


def _restrictions(environment: Mapping[str, str]) -> List[str]:
    """Arguments that set user, limits and environment inside bwrap; the environment must not reach bwrap itself."""
    cpu_time = limits.MAX_CPU_TIME
    environment = {"USER": NAME, "LOGNAME": NAME, **environment}
    drop = ["--clear-groups", "--no-new-privs", "--bounding-set=-all", "--inh-caps=-all"]
    return [
        *(["setpriv", f"--reuid={user()}", f"--regid={group()}", *drop, "--"] if os.geteuid() == 0 else []),
        *["prlimit", f"--as={limits.MAX_ADDRESS_SPACE}", f"--nproc={limits.MAX_TASKS}", f"--nofile={limits.MAX_FILES}"],
        *[f"--fsize={limits.MAX_HAND_IN}", "--core=0", f"--cpu={cpu_time}:{cpu_time + limits.CPU_GRACE}", "--"],
        *["env", "-i", *(f"{name}={value}" for name, value in environment.items())],
    ]


def _hidden(folder: Path) -> List[str]:
    """Options that hide files that not everybody may read in folders that are shown, such as /etc/shadow.

    When root starts the sandbox, the kernel denies access anyway. Another user may be in a group that may read such a
    file.
    """
    options: List[str] = []
    for entry in sorted(os.scandir(folder), key=lambda it: it.name):
        if entry.is_symlink():
            continue  # where it leads is shown or not by itself
        readable = (stat.S_IROTH | stat.S_IXOTH) if entry.is_dir() else stat.S_IROTH
        if entry.stat().st_mode & readable == readable:
            options += _hidden(Path(entry.path)) if entry.is_dir() else []
        elif entry.is_dir():
            options += ["--perms", "0000", "--tmpfs", entry.path]
        else:
            options += ["--ro-bind", "/dev/null", entry.path]  # a device can't be opened there
    return options


def _accounts(home: str) -> List[str]:
    """Options for lists of users and groups in which the sandbox's user has a name and a home."""
    users = f"{NAME}:x:{user()}:{group()}::{home}:/bin/sh\n{Path('/etc/passwd').read_text(errors='replace')}"
    groups = f"{NAME}:x:{group()}:\n{Path('/etc/group').read_text(errors='replace')}"
    readable = ["--perms", "0644", "--ro-bind-data"]
    return [*readable, users, "/etc/passwd", *readable, groups, "/etc/group"]


def _parents(paths: Sequence[Path]) -> List[Path]:
    """All parent directories, outermost first; bwrap would create them readable by root only."""
    parents = {parent for path in paths for parent in path.parents if parent != Path("/")}
    return sorted(parents - {Path("/tmp"), *map(Path, SYSTEM)})


def _writable(place: Path, size: int = limits.MAX_SPACE) -> List[str]:
    return ["--perms", "0777", "--size", str(size), "--tmpfs", str(place)]


def _mounts(option: str, paths: Iterable[Path]) -> List[str]:
    return [word for path in paths for word in (option, str(path), str(path))]


def open_sandbox(unsafe: bool, reads: Sequence[Path] = ()) -> Optional[Sandbox]:
    """The sandbox, or None if `unsafe`; GradingSetupError if it can't run, UngradableError if not in time."""
    if unsafe:
        return None
    advice = "--unsafe runs the submission without it, with all your rights"
    if shutil.which("bwrap") is None:
        raise GradingSetupError(f"bubblewrap is not installed; {advice}")
    if importlib.util.find_spec("seccomp") is None:
        raise GradingSetupError(f"python3-seccomp is not installed; {advice}")
    done = _trial([SOURCES, *(path for path in reads if path.exists())])
    if done.returncode != 0:
        if any(map(os.path.exists, CONTAINER_MARKS)):
            advice = f"`docker run {CONTAINER_OPTIONS}` lets it run in a container; {advice}"
        raise GradingSetupError(f"bubblewrap can't run here: {done.stderr.strip()}; {advice}")
    if done.stdout:
        remedy = shlex.join(["chmod", "-R", "go+rX", *map(str, [ROOT, *reads])])
        raise GradingSetupError(f"{done.stdout.strip()}: submissions run as a user who can't read it: {remedy}")
    return Sandbox(tuple(reads))


def _trial(shown: Sequence[Path]) -> "subprocess.CompletedProcess[str]":
    """What find says in the sandbox: the first file that can't be read; UngradableError if not in time."""
    find = ["/usr/bin/find", *map(str, shown), *UNREADABLE]
    try:
        trial = Sandbox(()).command_inside(find, {}, shown, Path("/tmp/home"))
        return subprocess.run(trial, capture_output=True, text=True, timeout=TRIAL_TIME)
    except subprocess.TimeoutExpired as error:
        raise UngradableError(f"bubblewrap did not run within {TRIAL_TIME:g} s") from error
