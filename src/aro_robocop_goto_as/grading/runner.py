"""A submission's node -> records: the probe as a process of its own, watched from outside with a deadline."""

import json
import os
import queue
import subprocess
import sys
import threading
import time
from dataclasses import dataclass
from pathlib import Path
from typing import Callable, Dict, List, Optional, Sequence

from ..errors import GradingError
from ..loopback import free_port
from . import building
from . import record as rec
from .guard import MEMORY, Guard, kill_group
from .sandbox import OWN_ENVIRONMENT, Cage
from .submission import Script, Submission

PROBE = "aro_robocop_goto_as.grading.probe.main"
Progress = Callable[[str], None]

BUDGET = 240.0  # [s, wall] for all scenarios of a part
END_PATIENCE = 5.0  # [s, wall]
LOG_LINES = 15
OWN_MEMORY = 1024 ** 3  # bytes that the probe may take besides the submission; it takes some 150 MB


@dataclass(frozen=True)
class Recorded:
    """What came of one part: records by scenario, and why some are missing."""

    records: Dict[str, rec.Record]
    problem: str = ""


def run(
    submission: Submission,
    script: Script,
    plan: Path,
    out: Path,
    state: Path,
    cage: Optional[Cage] = None,
    only: Sequence[str] = (),
    on_progress: Progress = lambda _: None,
    budget: float = BUDGET,
    watched: bool = False,
) -> Recorded:
    """Drive all scenarios of a script's part. Records and bags go to `out`; nothing of the submission can hang this.

    Watched, it is shown in RViz at real time; GradingError where RViz can't be opened.
    """
    out.mkdir(parents=True, exist_ok=True)
    home = out / "home"
    home.mkdir(exist_ok=True)
    environment = _environment(out, state)
    command, node_environment = script.command(), building.shown(submission.environment)
    # Logs right in the home: rospy would give a folder there to the home's owner, who the caged node is not; without
    # one it logs nothing at all.
    node_environment.update(
        {
            "ROS_HOME": str(home),
            "ROS_LOG_DIR": str(home),
            "ROS_HOSTNAME": "localhost",
            "HOME": str(home),
            "PYTHONUNBUFFERED": "1",
            "ROS_MASTER_URI": environment["ROS_MASTER_URI"],
        }
    )
    if cage is None:
        command = ["setpriv", "--pdeathsig", "KILL", "--", *command]  # in a cage bubblewrap sees to that
    else:
        command, node_environment = cage.around_node(command, node_environment, submission.reads, home), OWN_ENVIRONMENT
    job = out / f"{script.part}-job.json"
    job.write_text(
        json.dumps(
            {
                "part": script.part,
                "command": command,
                "environment": node_environment,
                "folder": str(home),
                "parameters": dict(submission.parameters),
                "plan": str(plan),
                "out": str(out),
                "only": list(only),
                "watched": watched,
            }
        )
    )
    probe = [sys.executable, "-m", PROBE, str(job)]
    return _watch(cage.around_probe(probe) if cage else probe, environment, out, script.part, on_progress, budget)


def _environment(out: Path, state: Path) -> Dict[str, str]:
    """The probe's: this workspace's, with Gazebo's types behind it."""
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


def _watch(
    command: List[str], environment: Dict[str, str], out: Path, part: str, on_progress: Progress, budget: float
) -> Recorded:
    lines: queue.Queue[Optional[str]] = queue.Queue()
    log = out / f"{part}-probe.log"
    with open(log, "wb") as errors:
        process = subprocess.Popen(
            command,
            env=environment,
            stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            stderr=errors,
            start_new_session=True,
        )
    guard = Guard(process.pid, memory=MEMORY + OWN_MEMORY)
    threading.Thread(target=_read, args=(process, lines), daemon=True).start()
    deadline, problem, scenario, patience = time.monotonic() + budget, "", "start", 0.0
    try:
        while True:
            try:
                line = lines.get(timeout=max(0.0, deadline - time.monotonic()))
            except queue.Empty:
                problem = (
                    f"time-out: not all scenarios were done within {budget:g} s of wall time, it was at {scenario}"
                )
                break
            if line is None:
                patience = END_PATIENCE
                break
            word, _, rest = line.partition(" ")
            if word == "begin":
                scenario = rest
                on_progress(rest)
            elif word == "slept":  # for whoever watches: not the submission's time
                deadline += float(rest)
            elif word == "error":
                raise GradingError(rest)
    finally:
        _end(process, patience)
        guard.stop()
    problem = problem or guard.reason
    if not problem and process.returncode != 0:
        problem = f"the run was cut short during {scenario} (status {process.returncode}): {_last(log)}"
    return Recorded(_records(out, part), problem)


def _read(process: "subprocess.Popen[bytes]", lines: "queue.Queue[Optional[str]]") -> None:
    assert process.stdout is not None
    for line in process.stdout:
        lines.put(line.decode(errors="replace").strip())
    lines.put(None)


def _end(process: "subprocess.Popen[bytes]", patience: float) -> None:
    """A probe that has said all gets a moment [s] to end its nodes; then its whole session goes."""
    try:
        process.wait(patience)
    except subprocess.TimeoutExpired:
        pass
    kill_group(process.pid)
    process.wait()


def _last(log: Path) -> str:
    lines = log.read_text(errors="replace").splitlines()
    return " | ".join(line.strip() for line in lines[-LOG_LINES:])[-600:]


def _records(out: Path, part: str) -> Dict[str, rec.Record]:
    found = [rec.read(path) for path in sorted(out.glob(f"{part}-*.json")) if not path.name.endswith("-job.json")]
    return {record.name: record for record in found}
