"""bubblewrap around a submission: a network of its own, a system it can only read, a home that is gone afterwards.

The probe runs in a network namespace of its own, loopback only, with a ROS master in it. The submission runs in that
same network, but with its own processes and files, and as a user who owns nothing: it sees neither the grader's
processes, records and points nor other submissions. Its limits are the kernel's, per process or user; wall time is the
runner's business.
"""

import os
import shutil
import subprocess
from dataclasses import dataclass
from pathlib import Path
from typing import List, Optional, Sequence, Tuple

from ..errors import GradingError

MEMORY = 4 * 1024 ** 3  # bytes of address space of each process; numpy alone reserves more than one
PROCESSES = 200  # threads counted; a rospy node has some 30
FILE_SIZE = 64 * 1024 ** 2  # bytes of a file
SPACE = 64 * 1024 ** 2  # bytes of each place that it can write to, all in memory
CPU_TIME = 200  # [s] of each process
FIRST_USER = 200_000  # uid and gid, above those in use; root would be exempt from process limits
USERS = 100_000
SYSTEM = ("/usr", "/bin", "/sbin", "/lib", "/lib32", "/lib64", "/opt", "/etc/alternatives", "/etc/group", "/etc/hosts",
          "/etc/ld.so.cache", "/etc/localtime", "/etc/nsswitch.conf", "/etc/passwd", "/etc/ros")
TRIAL = 10.0  # [s, wall]


@dataclass(frozen=True)
class Cage:
    """How the probe and a node are started inside."""

    reads: Tuple[Path, ...]  # besides the system: what built code needs, such as the virtual environment

    def around_probe(self, command: Sequence[str]) -> List[str]:
        """A network and processes of its own; nothing else is taken from the probe, which is ours."""
        return ["bwrap", "--die-with-parent", "--unshare-net", "--unshare-pid", "--dev-bind", "/", "/",
                "--proc", "/proc", "--", *command]

    def around_node(self, command: Sequence[str], reads: Sequence[Path], home: Path) -> List[str]:
        """Reads the system and its own files, writes a small home in memory, is alone with its processes."""
        wrap = ["bwrap", "--die-with-parent", "--unshare-pid", "--unshare-ipc", "--unshare-uts", "--cap-drop", "ALL"]
        if os.geteuid() == 0:
            wrap += ["--cap-add", "CAP_SETUID", "--cap-add", "CAP_SETGID"]
        wrap += ["--proc", "/proc", "--dev", "/dev"]
        for place in ("/tmp", "/dev/shm"):
            wrap += _writable(place)
        for parent in _parents([*map(Path, SYSTEM), *self.reads, *reads, home]):
            wrap += ["--perms", "0755", "--dir", str(parent)]
        for path in SYSTEM:
            wrap += ["--ro-bind-try", path, path]
        for read in (*self.reads, *reads):
            wrap += ["--ro-bind", str(read), str(read)]
        wrap += [*_writable(str(home)), "--chdir", str(home), "--"]
        if os.geteuid() == 0:
            # A user of this run alone: the kernel counts a user's processes, and runs must not starve one another.
            user = FIRST_USER + os.getpid() % USERS
            wrap += ["setpriv", f"--reuid={user}", f"--regid={user}", "--clear-groups", "--no-new-privs",
                     "--bounding-set=-all", "--inh-caps=-all", "--"]
        return [*wrap, "prlimit", f"--as={MEMORY}", f"--nproc={PROCESSES}", f"--fsize={FILE_SIZE}", f"--cpu={CPU_TIME}",
                "--core=0", "--", *command]


def _parents(paths: Sequence[Path]) -> List[Path]:
    """Every folder above them, from the top down: bwrap itself makes them for root only."""
    found = {parent for path in paths for parent in path.parents if parent != Path("/")}
    return sorted(found - {Path("/tmp"), *map(Path, SYSTEM)})


def _writable(place: str) -> List[str]:
    return ["--perms", "0777", "--size", str(SPACE), "--tmpfs", place]


def cage(unsafe: bool, reads: Sequence[Path] = ()) -> Optional[Cage]:
    """The cage, or None where none is wanted. GradingError where bubblewrap can't run."""
    if unsafe:
        return None
    advice = "--unsafe runs the submission without it, with all your rights"
    if shutil.which("bwrap") is None:
        raise GradingError(f"bubblewrap is not installed; {advice}")
    made = Cage(tuple(reads))
    trial = made.around_probe(made.around_node(["/bin/true"], (), Path("/tmp/home")))
    done = subprocess.run(trial, capture_output=True, text=True, timeout=TRIAL)
    if done.returncode != 0:
        raise GradingError(f"bubblewrap can't run here: {done.stderr.strip()}; {advice}")
    return made
