"""A control group that limits a command's memory, where systemd lets the user make one.

The guard looks ten times a second, and at what processes call their own. The kernel checks each page, also those of
pipes, sockets and files in memory, but most containers and systems without systemd delegate no group.
"""

import functools
import os
import subprocess
from pathlib import Path
from subprocess import DEVNULL
from typing import Tuple

from .guard import exceeded_memory
from .limits import MAX_SESSION_MEMORY

TRIAL_TIME = 5.0  # [s, wall]
GROUPS, OWN = Path("/sys/fs/cgroup"), Path("/proc/self/cgroup")
COUNTERS = Path("/proc/vmstat")


@functools.lru_cache(maxsize=None)
def prefix() -> Tuple[str, ...]:
    """What to put before a command line so that it runs in a group of its own; nothing where there can't be one.

    Delegate=yes: after the kernel has killed a process, systemd leaves the others alone.
    """
    properties = f"MemoryMax={MAX_SESSION_MEMORY}", "MemorySwapMax=0", "Delegate=yes"
    command = ["systemd-run", "--scope", "--quiet", "--collect", "--description=robocop"]
    command += [*(f"--property={it}" for it in properties), "--"]
    if os.getuid():
        command = ["env", f"XDG_RUNTIME_DIR=/run/user/{os.getuid()}", command[0], "--user", *command[1:]]
    read = ("/bin/sh", "-c", f"cat {GROUPS}$(sed -n s/^0:://p {OWN})/memory.max")
    try:
        trial = subprocess.run([*command, *read], stdin=DEVNULL, capture_output=True, text=True, timeout=TRIAL_TIME)
    except (OSError, subprocess.TimeoutExpired):
        return ()
    return tuple(command) if trial.stdout.strip() == str(MAX_SESSION_MEMORY) else ()


def reason() -> str:
    """Why the kernel has killed a process of the caller's group, if that was because the group took too much memory."""
    try:
        (name,) = [line[3:] for line in OWN.read_text().splitlines() if line.startswith("0::")]
        group = Path(f"{GROUPS}{name}")
        if (group / "memory.max").read_text().strip() != str(MAX_SESSION_MEMORY):
            return ""  # the group of a container or a session: what it lacks is not the submission's fault
        events = dict(line.split() for line in (group / "memory.events").read_text().splitlines())
        # Kills are counted also where the machine lacked memory, and not the group.
        has_killed = int(events["oom"]) > 0 and int(events["oom_kill"]) > 0
        return exceeded_memory(MAX_SESSION_MEMORY) if has_killed else ""
    except (OSError, ValueError, KeyError):
        return ""


def kernel_kills() -> int:
    """How many processes the kernel has killed since its start because memory ran out; 0 if it does not tell."""
    try:
        return int(dict(line.split() for line in COUNTERS.read_text().splitlines())["oom_kill"])
    except (OSError, ValueError, KeyError):
        return 0
