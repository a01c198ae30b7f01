"""Runs a session as a process for one part of a submission; when its time limit is exceeded there is no grade."""

import math
import os
import sys
import threading
import time
from dataclasses import dataclass
from pathlib import Path
from subprocess import PIPE
from typing import Callable, Dict, List, Optional, Sequence, Tuple

from aro_robocop_goto_as.process import child
from aro_robocop_goto_as.process.ports import free_port
from robocop_hosting.workspace import compat_folder, places

from . import record as rec
from .attempts import counting
from .errors import UngradableError
from .faults import changed_sources
from .packages import provide
from .plan import AGAIN, Plan
from .sandbox.bubblewrap import AGENT, OWN_ENVIRONMENT, Sandbox
from .sandbox.build import public
from .sandbox.guard import Guard, kernel_kills
from .sandbox.limits import MAX_CPU_TIME, MAX_SESSION_MEMORY
from .session.job import Job
from .submission import Script, Submission

SESSION = "robocop_grading.session.main"
Progress = Callable[[str, str], None]  # part, scenario

# [s, wall] for all scenarios of a part. A quiet machine needs ten; a right server beside sixty busy processes, six
# minutes. A node that uses too much processor time is ended by its own limit.
BUDGET = 3600.0
END_TIMEOUT = 600.0  # [s, wall] for the end of a session that has closed its output; it needs milliseconds
LOG_LINES = 15


@dataclass(frozen=True)
class Recorded:
    """The outcome of one part: records by scenario, and why some are missing."""

    records: Dict[str, rec.Record]
    problem: str = ""
    killed: str = ""  # what was killed, but not by the grader; empty if nothing was
    excused: bool = False  # the submission may not be to blame: memory ran out, or the grader's process was killed
    told: Sequence[str] = ()  # notes for the report about scenarios that were repeated


@dataclass(frozen=True)
class Runner:
    """How submissions are run."""

    plan: Plan
    state: Path
    sandbox: Optional[Sandbox] = None
    on_progress: Progress = lambda _part, _scenario: None
    budget: float = BUDGET  # [s, wall]

    def run(self, submission: Submission, script: Script, out: Path) -> Recorded:
        """Run the scenarios of a script's part, which ends whatever the submission does; records and bags go to `out`.

        UngradableError if the session can't be started or the machine has no time for it, or if the plan's packages
        can't be provided.
        """
        home = out / "home"
        home.mkdir(parents=True, exist_ok=True)
        command, packages = script.command(), provide(self.plan.packages, self.state)
        reads = [*submission.reads, AGENT, *([packages] if packages is not None else [])]
        known = {**public(submission.environment), **script.variables}
        node_environment = {
            **known,
            "PYTHONPATH": ":".join(map(str, filter(None, (known.get("PYTHONPATH"), packages)))),
            "ROS_HOME": str(home),
            # An existing directory: rospy would chown a new one, which the sandboxed user may not, and log nothing.
            "ROS_LOG_DIR": str(home),
            "ROS_HOSTNAME": "localhost",
            "HOME": str(home),
            "TMPDIR": str(home),
            "PYTHONUNBUFFERED": "1",
            "ROS_MASTER_URI": f"http://localhost:{free_port()}",  # programs that the node starts find no master there
        }
        if self.sandbox is None:
            command = ["setpriv", "--pdeathsig", "KILL", "--", *command]  # as bubblewrap's --die-with-parent does
        else:
            command = self.sandbox.command_inside(command, node_environment, reads, home)
            node_environment = OWN_ENVIRONMENT
        parameters, file = dict(submission.parameters), out / f"{script.part}.job"
        cpu_time = math.inf if self.sandbox is None else float(MAX_CPU_TIME)
        rec.write(Job(script.part, tuple(command), node_environment, home, out, self.plan, parameters, cpu_time), file)
        session = [sys.executable, "-m", SESSION, str(file)]
        if self.sandbox is not None:
            session = self.sandbox.session_command(session)
        messages = compat_folder(places()[1], self.state) / "devel" / "lib" / "python3" / "dist-packages"  # Gazebo's
        paths = f"{os.environ.get('PYTHONPATH', '')}:{messages}"
        return self.supervise(session, {**os.environ, "PYTHONPATH": paths, "TMPDIR": str(out)}, out, script.part)

    def supervise(self, command: List[str], environment: Dict[str, str], out: Path, part: str) -> Recorded:
        """Start a session, follow what it reports on its standard output, and end it after the budget.

        UngradableError if the submission is not to blame. A session that fails in another way after it has begun a
        scenario is judged.
        """
        log = out / f"{part}-session.log"
        process = child.start(command, log, environment, stdout=PIPE)
        guard = Guard(process.pid, memory=MAX_SESSION_MEMORY, processes=math.inf)  # the session limits the node's
        kills = kernel_kills()
        deadline, scenario, grace = time.monotonic() + self.budget, "", 0.0
        timer = threading.Timer(self.budget, child.kill_tree, [process.pid])  # ends the lines, too
        timer.start()
        try:
            for line in process.stdout or ():
                word, _, rest = line.decode(errors="replace").strip().partition(" ")
                if word == "begin":
                    scenario = rest
                    self.on_progress(part, rest)
                elif word == "error":
                    raise UngradableError(rest)
            if time.monotonic() >= deadline:
                raise UngradableError(
                    f"{part}: not done within {self.budget:g} s, stopped at {scenario or 'its start'}"
                )
            grace = END_TIMEOUT
        finally:
            timer.cancel()
            status = child.end(process, None, grace)
            guard.stop()
        if not scenario:
            raise UngradableError(
                f"{part}: the grader's session did not start (status {status}): {_end_of(log)}{changed_sources()}"
            )
        records, told = self._counting(out, part)
        problem, killed = guard.reason, ""
        for name in (it.name for it in records.values() if any(death.is_unexplained for death in it.deaths)):
            killed = f"the {part} was killed in scenario {name}"
        excused = kernel_kills() > kills
        if not problem and status != 0:
            problem = f"the run was cut short during {scenario} (status {status}): {_end_of(log)}"
            if status in rec.KILLED:  # not because of the submission, whose processes the kernel ends first
                killed, excused = f"the grader's own process was killed in scenario {scenario}", True
        return Recorded(records, problem, killed, excused, told)

    def _counting(self, out: Path, part: str) -> Tuple[Dict[str, rec.Record], List[str]]:
        """The records that count, whose bags get their scenarios' names, and what to say of repeated scenarios."""
        found = (rec.read(rec.Record, path) for path in sorted(out.glob(f"{part}-*.record")))
        records, counted, told = counting(self.plan, {record.name: record for record in found})
        for name in counted:
            (out / f"{part}-{name}{AGAIN}.bag").replace(out / f"{part}-{name}.bag")
        return records, told


def _end_of(log: Path) -> str:
    return " | ".join(map(str.strip, log.read_text(errors="replace").splitlines()[-LOG_LINES:]))[-600:]
