"""bubblewrap around other people's code: a network of its own, a system to read only, a home that is soon gone.

The probe runs in a network namespace of its own, loopback only, with a ROS master in it. The submission runs in that
same network, but with its own processes and files, and as a user who owns nothing: it sees neither the grader's
processes, records and points nor other submissions. Building it is running it, so that is done inside as well. Limits
here are the kernel's, per process or user; what all processes take together is guard.py's business, wall time the
runner's.
"""

import os
import shutil
import subprocess
from dataclasses import dataclass
from pathlib import Path
from typing import Iterable, List, Mapping, Optional, Sequence, Tuple

from ..errors import GradingError

MEMORY = 4 * 1024 ** 3  # bytes of address space of each process; numpy alone reserves more than one
PROCESSES = 200  # threads counted; a rospy node has some 30
FILE_SIZE = 64 * 1024 ** 2  # bytes of a file
SPACE = 64 * 1024 ** 2  # bytes of each place that it can write to, all in memory
CPU_TIME = 200  # [s] of each process
WATCHED_CPU_TIME = 2000  # [s] likewise, of a node that runs at real time: a right one may wait in a busy loop
FIRST_USER = 200_000  # uid and gid, above those in use; root would be exempt from process limits
USERS = 100_000
SYSTEM = ("/usr", "/bin", "/sbin", "/lib", "/lib32", "/lib64", "/opt", "/etc/alternatives", "/etc/catkin", "/etc/group",
          "/etc/hosts", "/etc/ld.so.cache", "/etc/localtime", "/etc/nsswitch.conf", "/etc/passwd", "/etc/ros")
OWN_ENVIRONMENT = {"PATH": "/usr/bin:/bin"}  # of bwrap itself, which is ours
SEALED = ("--remount-ro", "/", "--remount-ro", "/dev")  # else a user's own cage lets him write there without limit
TRIAL = 10.0  # [s, wall]


@dataclass(frozen=True)
class Cage:
    """How the probe, a node and a build are started inside."""

    reads: Tuple[Path, ...]  # besides the system: what built code needs, such as the virtual environment
    cpu_time: int = CPU_TIME

    def around_probe(self, command: Sequence[str]) -> List[str]:
        """A network and processes of its own; nothing else is taken from the probe, which is ours."""
        return ["bwrap", "--die-with-parent", "--unshare-net", "--unshare-pid", "--dev-bind", "/", "/",
                "--proc", "/proc", "--", *command]

    def around_node(self, command: Sequence[str], environment: Mapping[str, str], reads: Sequence[Path],
                    home: Path) -> List[str]:
        """Reads the system and its own files, writes a small home in memory, is alone with its processes."""
        return [*self._walls([*reads, home]), *_bound("--ro-bind", [*self.reads, *reads]), *_writable(str(home)),
                *SEALED, "--chdir", str(home), "--", *_rights(environment, self.cpu_time), *command]

    def around_build(self, command: Sequence[str], environment: Mapping[str, str], reads: Sequence[Path],
                     folder: Path) -> List[str]:
        """The same without any network; `folder`, which has to belong to `user()`, is the place it can write to."""
        return [*self._walls([*reads, folder]), "--unshare-net", *_bound("--ro-bind", [*self.reads, *reads]),
                *_bound("--bind", [folder]), *SEALED, "--chdir", str(folder), "--",
                *_rights(environment, CPU_TIME), *command]

    def _walls(self, seen: Sequence[Path]) -> List[str]:
        wrap = ["bwrap", "--die-with-parent", "--unshare-pid", "--unshare-ipc", "--unshare-uts", "--cap-drop", "ALL"]
        if os.geteuid() == 0:
            wrap += ["--cap-add", "CAP_SETUID", "--cap-add", "CAP_SETGID"]
        wrap += ["--proc", "/proc", "--dev", "/dev"]
        for place in ("/tmp", "/dev/shm"):
            wrap += _writable(place)
        for parent in _parents([*map(Path, SYSTEM), *self.reads, *seen]):
            wrap += ["--perms", "0755", "--dir", str(parent)]
        return [*wrap, *_bound("--ro-bind-try", map(Path, SYSTEM))]


def user() -> int:
    """Who caged code is when root starts it: a user of this process alone.

    The kernel counts a user's processes, and runs at the same time must not starve one another.
    """
    return FIRST_USER + os.getpid() % USERS if os.geteuid() == 0 else os.geteuid()


def hand_over(folder: Path, owner: int) -> None:
    """Give a folder with all in it to a user; only root can, and only root needs it. Links are not followed."""
    if os.geteuid() == 0:
        for place, folders, files in os.walk(folder):
            for name in (".", *folders, *files):
                os.chown(os.path.join(place, name), owner, owner, follow_symlinks=False)


def _rights(environment: Mapping[str, str], cpu_time: int) -> List[str]:
    """Who it is, what it may take, and its environment, which only comes into force behind all the walls."""
    command = []
    if os.geteuid() == 0:
        command = ["setpriv", f"--reuid={user()}", f"--regid={user()}", "--clear-groups", "--no-new-privs",
                   "--bounding-set=-all", "--inh-caps=-all", "--"]
    return [*command, "prlimit", f"--as={MEMORY}", f"--nproc={PROCESSES}", f"--fsize={FILE_SIZE}", f"--cpu={cpu_time}",
            "--core=0", "--", "env", "-i", *(f"{name}={value}" for name, value in environment.items())]


def _parents(paths: Sequence[Path]) -> List[Path]:
    """Every folder above them, from the top down: bwrap itself makes them for root only."""
    found = {parent for path in paths for parent in path.parents if parent != Path("/")}
    return sorted(found - {Path("/tmp"), *map(Path, SYSTEM)})


def _writable(place: str) -> List[str]:
    return ["--perms", "0777", "--size", str(SPACE), "--tmpfs", place]


def _bound(how: str, paths: Iterable[Path]) -> List[str]:
    return [word for path in paths for word in (how, str(path), str(path))]


def cage(unsafe: bool, reads: Sequence[Path] = (), cpu_time: int = CPU_TIME) -> Optional[Cage]:
    """The cage, or None where none is wanted. GradingError where bubblewrap can't run."""
    if unsafe:
        return None
    advice = "--unsafe runs the submission without it, with all your rights"
    if shutil.which("bwrap") is None:
        raise GradingError(f"bubblewrap is not installed; {advice}")
    made = Cage(tuple(reads), cpu_time)
    trial = Cage(()).around_probe(Cage(()).around_node(["/bin/true"], {}, (), Path("/tmp/home")))
    done = subprocess.run(trial, capture_output=True, text=True, timeout=TRIAL)
    if done.returncode != 0:
        raise GradingError(f"bubblewrap can't run here: {done.stderr.strip()}; {advice}")
    return made
