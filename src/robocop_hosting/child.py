"""Child processes: started in a session of their own, ended together with their descendants."""

import contextlib
import os
import signal
import subprocess
import time
from pathlib import Path
from typing import Any, Dict, Mapping, Optional, Sequence, Set

import psutil

END_TIMEOUT = 10.0  # [s, wall] for a process to end after a signal
STOP_TIMEOUT = 0.5  # [s, wall] for SIGSTOP to take effect; the parent of a vfork cannot stop until its child execs

Child = subprocess.Popen  # what start() returns; an alias, so that callers need not import subprocess


def start(
    command: Sequence[str],
    log: Optional[Path] = None,
    environment: Optional[Mapping[str, str]] = None,
    folder: Optional[Path] = None,
    **options: Any,
) -> "Child[Any]":
    """Start a command whose output goes to `log` (overwritten; None: discarded) and whose input is empty.

    It leads a session, so Ctrl-C in a terminal reaches only the caller, and kill_tree() finds its process group.
    `options` of subprocess.Popen take precedence: stdout=PIPE, text=True, pass_fds=[3], ...
    """
    with open(log or os.devnull, "wb") as output:
        defaults: Dict[str, Any] = {
            "stdin": subprocess.DEVNULL,
            "stdout": output,
            "stderr": output,
            "start_new_session": True,
        }
        return subprocess.Popen(list(command), env=environment, cwd=folder, **{**defaults, **options})


def end(child: "Child[Any]", number: Optional[int] = signal.SIGTERM, grace: float = END_TIMEOUT) -> int:
    """End a child and its descendants; returns the child's exit status.

    Sends signal `number` (None: no signal), waits up to `grace` [s, wall] for the child to end, then kills all
    processes that are left. Closes the pipes to the child.
    """
    runs = child.poll() is None
    family = _family(child.pid) if runs else set()  # before the signal: orphans can't be traced back to the child
    if runs:
        if number is not None:
            child.send_signal(number)
        with contextlib.suppress(subprocess.TimeoutExpired):
            child.wait(grace)
    _kill(child.pid, family)
    status = int(child.wait())
    for pipe in (child.stdin, child.stdout, child.stderr):
        if pipe is not None:
            with contextlib.suppress(BrokenPipeError):
                pipe.close()
    return status


def kill_tree(pid: int) -> None:
    """SIGKILL a child that has not been waited for, its descendants, and its process group if it leads one.

    A descendant in another session whose parent has already ended is not found; see orphans.py for those.
    """
    _kill(pid, _family(pid))


def _family(pid: int) -> Set["psutil.Process"]:
    """A process and all its descendants; empty if it has ended."""
    try:
        process = psutil.Process(pid)
        return {process, *process.children(recursive=True)}
    except psutil.NoSuchProcess:
        return set()


def _kill(group: int, family: Set["psutil.Process"]) -> None:
    stopped = _suspended(family)
    with contextlib.suppress(ProcessLookupError):
        os.killpg(group, signal.SIGKILL)
    for process in stopped:
        with contextlib.suppress(psutil.Error):
            process.kill()


def _suspended(members: Set["psutil.Process"]) -> Set["psutil.Process"]:
    """These processes and their descendants, all stopped: a running process could start another one meanwhile."""
    deadline = time.monotonic() + STOP_TIMEOUT
    while True:
        for process in members:
            with contextlib.suppress(psutil.Error):
                process.suspend()
        stopped = all(map(_cannot_fork, members))  # before looking for children: a fork under way completes first
        parents = {process.pid for process in members if process.is_running()}  # False where the pid was reused
        children = {process for process in psutil.process_iter(["ppid"]) if process.info["ppid"] in parents}
        if children <= members and (stopped or time.monotonic() > deadline):
            return members
        members = members | children


def _cannot_fork(process: "psutil.Process") -> bool:
    try:
        return process.status() in (psutil.STATUS_STOPPED, psutil.STATUS_ZOMBIE, psutil.STATUS_DEAD)
    except psutil.Error:
        return True
