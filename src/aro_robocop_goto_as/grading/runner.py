"""A submission's node -> records: runs the probe as a process with a deadline on the wall clock."""

import json
import os
import queue
import sys
import threading
import time
from dataclasses import dataclass
from pathlib import Path
from subprocess import PIPE
from typing import Callable, Dict, List, Optional, Sequence

from ..errors import UngradableError
from ..process import child
from ..process.ports import free_port
from . import memory_group
from . import record as rec
from .plan import Plan
from .resource_guard import Guard
from .sandbox import OWN_ENVIRONMENT, Sandbox
from .sandboxed_build import public
from .submission import Script, Submission
from .viewer import Viewer

PROBE = "aro_robocop_goto_as.grading.probe.main"
Progress = Callable[[str], None]

BUDGET = 240.0  # [s, wall] for all scenarios of a part
END_TIMEOUT = 5.0  # [s, wall]
LOG_LINES = 15


@dataclass(frozen=True)
class Recorded:
    """The outcome of one part: records by scenario, and why some are missing."""

    records: Dict[str, rec.Record]
    problem: str = ""
    killed: str = ""  # what was killed from outside, if anything was: then the records say nothing about the submission


def run(
    submission: Submission,
    script: Script,
    plan: Plan,
    out: Path,
    state: Path,
    sandbox: Optional[Sandbox] = None,
    only: Sequence[str] = (),
    on_progress: Progress = lambda _: None,
    budget: float = BUDGET,
    viewer: Optional[Viewer] = None,
) -> Recorded:
    """Run all scenarios of a script's part; records and bags go to `out`. It ends whatever the submission does.

    A viewer shows the run at real time. UngradableError where it or the ROS master can't be started.
    """
    out.mkdir(parents=True, exist_ok=True)
    home = out / "home"
    home.mkdir(exist_ok=True)
    environment = _environment(out, state)
    command = script.command()
    node_environment = {
        **public(submission.environment),
        "ROS_HOME": str(home),
        # An existing directory: rospy would chown a new one, which the sandboxed user may not, and then log nothing.
        "ROS_LOG_DIR": str(home),
        "ROS_HOSTNAME": "localhost",
        "HOME": str(home),
        "TMPDIR": str(home),
        "PYTHONUNBUFFERED": "1",
        "ROS_MASTER_URI": environment["ROS_MASTER_URI"],
    }
    if sandbox is None:
        command = ["setpriv", "--pdeathsig", "KILL", "--", *command]  # as bubblewrap's --die-with-parent does
    else:
        command = sandbox.node_command(command, node_environment, submission.reads, home)
        node_environment = OWN_ENVIRONMENT
    job = out / f"{script.part}-job.json"
    job.write_text(
        json.dumps(
            {
                "part": script.part,
                "command": command,
                "environment": node_environment,
                "folder": str(home),
                "parameters": dict(submission.parameters),
                "plan": str(plan.path),
                "seed": plan.seed,
                "out": str(out),
                "only": list(only),
                "viewer": viewer and viewer.as_dict(),
            }
        )
    )
    probe = [sys.executable, "-m", PROBE, str(job)]
    if sandbox is not None:
        probe = [*memory_group.prefix(), *sandbox.probe_command(probe)]
    inherited = viewer.descriptors if viewer is not None else ()
    return _supervise(probe, environment, out, script.part, on_progress, budget, inherited)


def _environment(out: Path, state: Path) -> Dict[str, str]:
    """The probe's environment: this workspace, with Gazebo's message types after it."""
    types = state / "compat" / "devel" / "lib" / "python3" / "dist-packages"
    environment = {
        **os.environ,
        "ROS_MASTER_URI": f"http://localhost:{free_port()}",
        "ROS_HOSTNAME": "localhost",
        "ROS_HOME": str(out / "ros"),
        "ROS_LOG_DIR": str(out / "ros"),
        "TMPDIR": str(out),
    }
    environment["PYTHONPATH"] = f"{environment.get('PYTHONPATH', '')}:{types}"
    environment.pop("ROS_IP", None)
    return environment


def _supervise(
    command: List[str],
    environment: Dict[str, str],
    out: Path,
    part: str,
    on_progress: Progress,
    budget: float,
    inherited: Sequence[int] = (),
) -> Recorded:
    """Start the probe, follow what it reports on its standard output, and end it after `budget` [s, wall].

    It inherits these file descriptors.
    """
    lines: queue.Queue[Optional[str]] = queue.Queue()
    log = out / f"{part}-probe.log"
    process = child.start(command, log, environment, stdout=PIPE, pass_fds=inherited)
    guard = Guard(process.pid, memory=memory_group.LIMIT)
    threading.Thread(target=_read, args=(process, lines), daemon=True).start()
    deadline, problem, scenario, grace = time.monotonic() + budget, "", "start", 0.0
    try:
        while True:
            try:
                line = lines.get(timeout=max(0.0, deadline - time.monotonic()))
            except queue.Empty:
                problem = f"time-out: the scenarios took longer than {budget:g} s of wall time, stopped at {scenario}"
                break
            if line is None:
                grace = END_TIMEOUT
                break
            word, _, rest = line.partition(" ")
            if word == "begin":
                scenario = rest
                on_progress(rest)
            elif word == "slept":  # to show the run at real time: does not count as the submission's time
                deadline += float(rest)
            elif word == "error":
                raise UngradableError(rest)
    finally:
        status = child.end(process, None, grace)
        guard.stop()
    records, killed = records_in(out, part), ""
    for record in records.values():
        if any(death.is_from_outside for death in record.deaths):
            killed = f"the {part} was killed in scenario {record.name}"
    problem = problem or guard.reason
    if not problem and status != 0:
        problem = f"the run was cut short during {scenario} (status {status}): {_last_lines(log)}"
        if status in rec.KILLED:
            killed = f"the grader's own process was killed in scenario {scenario}"
    return Recorded(records, problem, killed)


def _read(process: "child.Child[bytes]", lines: "queue.Queue[Optional[str]]") -> None:
    assert process.stdout is not None
    for line in process.stdout:
        lines.put(line.decode(errors="replace").strip())
    lines.put(None)


def _last_lines(log: Path) -> str:
    lines = log.read_text(errors="replace").splitlines()
    return " | ".join(line.strip() for line in lines[-LOG_LINES:])[-600:]


def records_in(out: Path, part: str) -> Dict[str, rec.Record]:
    """The records of a part so far, by scenario."""
    records = [rec.read(path) for path in sorted(out.glob(f"{part}-*.json")) if not path.name.endswith("-job.json")]
    return {record.name: record for record in records}
