"""Runs one part of a submission; when its time limit is exceeded there is no grade."""

import math
import sys
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Callable, Dict, Optional, Sequence

from robocop_hosting.ports import free_port
from robocop_hosting.workspace import compat_folder, places

from . import record as rec
from .attempts import counting
from .errors import GraderLostError, UngradableError
from .packages import provide
from .plan import AGAIN, Plan
from .sandbox.bubblewrap import AGENT, HAND_IN, OWN_ENVIRONMENT, Sandbox, public
from .sandbox.guard import kernel_kills
from .sandbox.limits import MAX_CPU_TIME
from .session.bridge_run import BridgeRun
from .session.job import Job
from .session.server_run import ServerRun
from .session.stage import Stage
from .submission import Script, Submission

Progress = Callable[[str, str], None]  # part, scenario

# [s, wall] for all scenarios of a part. A quiet machine needs ten; a right server beside sixty busy processes, six
# minutes. A node that uses too much processor time is ended by its own limit.
BUDGET = 3600.0
UNPACK = f'bsdtar -x -f "$0" -C {HAND_IN} && exec "$@"'


@dataclass(frozen=True)
class Recorded:
    """The outcome of one part: records by scenario, and why some are missing."""

    records: Dict[str, rec.Record]
    problem: str = ""
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
        """Run the scenarios of a script's part, which ends whatever the submission does; bags go to `out`.

        UngradableError if the machine has no time or no memory for it, or if the plan's packages can't be provided.
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
            if submission.archive is not None:
                reads.append(submission.archive)
                command = ["sh", "-c", UNPACK, str(submission.archive), *command]
            command = self.sandbox.command_inside(command, node_environment, reads, home)
            node_environment = OWN_ENVIRONMENT
        job = Job(
            part=script.part,
            command=tuple(command),
            environment=node_environment,
            folder=home,
            out=out,
            plan=self.plan,
            parameters=submission.parameters,
            cpu_time=math.inf if self.sandbox is None else float(MAX_CPU_TIME),
            budget=self.budget,
            on_scenario=partial(self.on_progress, script.part),
        )
        messages = compat_folder(places()[1], self.state) / "devel" / "lib" / "python3" / "dist-packages"
        if str(messages) not in sys.path:
            sys.path.append(str(messages))  # Gazebo's, for its services
        return self._recorded(job)

    def _recorded(self, job: Job) -> Recorded:
        kills, problem, stage = kernel_kills(), "", Stage()
        run = ServerRun(job, stage) if job.part == "server" else BridgeRun(job, stage)
        try:
            run.scenarios()
        except GraderLostError as error:
            problem = f"the run was cut short during {run.scenario}: {error}"
        except OSError as error:  # a full disk, for example: nothing that a node can bring about
            raise UngradableError(str(error)) from error
        finally:
            run.close()
        ends = [end for record in run.records.values() for end in record.node_ends]
        if kernel_kills() > kills and any(end.is_unexplained for end in ends):
            raise UngradableError(f"{job.part}: the machine ran out of memory")
        records, counted, told = counting(self.plan, run.records)
        for name in counted:
            (job.out / f"{job.part}-{name}{AGAIN}.bag").replace(job.out / f"{job.part}-{name}.bag")
        return Recorded(records, problem, told)
