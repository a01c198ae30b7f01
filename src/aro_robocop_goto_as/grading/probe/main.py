"""The probe's process: one part of a submission against all scenarios of that part, a record file for each."""

import json
import os
import subprocess
import sys
import time
from pathlib import Path
from typing import Any, Dict, List, Optional
from urllib.parse import urlparse

import rosgraph
import rospy

from .. import record as rec
from ..plan import BRIDGE_SCENARIOS, load
from .bridge import BridgeRun
from .nodes import Node
from .run import NODE_LOST, GraderLost, Run
from .server import ServerRun
from .stage import Stage
from .watch import Watch, WatchError

MASTER_PATIENCE = 20.0  # [s, wall]


class Job:
    """What the grader asks for, a JSON file: part, node's command, environment and folder, plan, out, only, watched."""

    def __init__(self, path: str) -> None:
        raw: Dict[str, Any] = json.loads(Path(path).read_text())
        self.part: str = raw["part"]
        self.command: List[str] = raw["command"]
        self.environment: Dict[str, str] = raw["environment"]
        self.folder: str = raw["folder"]
        self.plan = load(Path(raw["plan"]))
        self.out = Path(raw["out"])
        self.only: List[str] = raw["only"]
        self.parameters: Dict[str, Any] = raw["parameters"]
        self.watch: Optional[Watch] = None
        self.watched: bool = raw["watched"]

    def launch(self, run: Run) -> Node:
        """Start the node that is graded."""
        return Node(self.command, self.environment, self.folder, lambda line: run.stage.inbox.put(("line", line)))

    def wanted(self, name: str) -> bool:
        """Whether a scenario is to be run."""
        return not self.only or name in self.only

    def begin(self, name: str, about: str) -> None:
        """Say which scenario comes, and show it to whoever watches."""
        print(f"begin {name}", flush=True)
        if self.watch is not None:
            self.watch.begin(f"{self.part}: {name}", about)

    def keep(self, record: rec.Record) -> None:
        """Write a record, then say so."""
        rec.write(record, self.out / f"{self.part}-{record.name}.json")
        print(f"done {record.name}", flush=True)

    def bag(self, name: str) -> str:
        """Where a scenario's bag goes."""
        return str(self.out / f"{self.part}-{name}.bag")


def _serve_gazebo(stage: Stage) -> None:
    """For nodes that wait for Gazebo's services; its types are there where the submission was built upon compat/."""
    try:
        from ...nodes.gazebo import GazeboServices
    except ImportError:
        return
    GazeboServices(stage)  # type: ignore[arg-type]


def _server(job: Job, stage: Stage) -> None:
    it = ServerRun(job.plan, job.launch, stage)
    try:
        job.begin("start", "The node comes up")
        start = it.start(job.bag("start"))
        job.keep(start)
        for index, scenario in enumerate(job.plan.scenarios, 1):
            if start.up and job.wanted(scenario.name):
                job.begin(scenario.name, scenario.about)
                job.keep(it.scenario(index, scenario, job.bag(scenario.name)))
    finally:
        it.close()


def _bridge(job: Job, stage: Stage) -> None:
    it = BridgeRun(job.plan, job.launch, stage)
    try:
        for name in BRIDGE_SCENARIOS:
            drive = getattr(it, name)
            job.begin(name, drive.__doc__)
            job.keep(drive(job.bag(name)))
    finally:
        it.close()


def _start_master() -> None:
    """A master at ROS_MASTER_URI, for this run alone."""
    port = urlparse(os.environ["ROS_MASTER_URI"]).port
    subprocess.Popen(["rosmaster", "--core", "-p", str(port)], stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL,
                     stderr=subprocess.DEVNULL)
    deadline = time.monotonic() + MASTER_PATIENCE
    while not rosgraph.is_master_online():
        if time.monotonic() > deadline:
            sys.exit(f"no ROS master within {MASTER_PATIENCE:g} s")
        time.sleep(0.02)


def main() -> None:
    """Usage: main JOB.json, with ROS_MASTER_URI where a master may be started."""
    job = Job(sys.argv[1])
    _start_master()
    rospy.set_param("/use_sim_time", True)
    for name, value in job.parameters.items():
        rospy.set_param(name, value)
    rospy.init_node("robocop_sim", disable_rostime=True, disable_signals=True, argv=[])
    stage = Stage(job.plan)
    _serve_gazebo(stage)
    stage.repeat_clock()
    status = 0
    try:
        if job.watched:
            job.watch = stage.watch = Watch(stage.robot, job.plan, job.out / f"{job.part}-rviz.log")
            job.watch.open()
        (_server if job.part == "server" else _bridge)(job, stage)
    except GraderLost as error:
        print(error, file=sys.stderr)
        status = 1
    except rospy.ROSException:  # a shutdown closes topics at any moment, in the middle of a tick too
        if not rospy.core.is_shutdown_requested():
            raise
        print(NODE_LOST, file=sys.stderr)
        status = 1
    except WatchError as error:
        print(f"error {error}")
        status = 1
    finally:
        if job.watch is not None:
            job.watch.close()
    sys.stdout.flush()
    sys.stderr.flush()
    os._exit(status)  # rospy's threads may still be talking to a node that is gone


if __name__ == "__main__":
    main()
