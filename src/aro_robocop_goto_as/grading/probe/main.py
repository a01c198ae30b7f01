"""The probe: runs all scenarios of one part of a submission, and writes a record file for each."""

import json
import os
import sys
import time
from pathlib import Path
from typing import Any, Dict, List, Optional, Sequence
from urllib.parse import urlparse

import rosgraph
import rospy

from ...errors import GraderLostError, WatchError
from ...process import child
from ...ros.private_api import shutdown_has_begun
from .. import record as rec
from ..plan import BRIDGE_SCENARIOS, load
from ..viewer import Viewer
from .bridge import BridgeRun
from .nodes import Node
from .run import NODE_LOST, Run
from .server import ServerRun
from .stage import PARAMS, Stage
from .watch import Watch

MASTER_TIMEOUT = 60.0  # [s, wall]


class Job:
    """The grader's request, a JSON file written by runner.run."""

    def __init__(self, path: str) -> None:
        raw: Dict[str, Any] = json.loads(Path(path).read_text())
        self.part: str = raw["part"]
        self.command: List[str] = raw["command"]
        self.environment: Dict[str, str] = raw["environment"]
        self.folder: str = raw["folder"]
        self.plan = load(Path(raw["plan"]), raw["seed"])
        self.out = Path(raw["out"])
        self.only: List[str] = raw["only"]  # scenarios; empty: all
        self.parameters: Dict[str, Any] = raw["parameters"]
        self.watch: Optional[Watch] = None
        self.viewer = Viewer(**raw["viewer"]) if raw["viewer"] else None

    def launch(self, run: Run) -> Node:
        """Start the node that is graded."""
        return Node(self.command, self.environment, self.folder, lambda line: run.stage.post("line", line))

    def wanted(self, name: str) -> bool:
        """Whether this scenario is to be run."""
        return not self.only or name in self.only

    def begin(self, name: str, about: str) -> None:
        """Announce the next scenario to the grader, and in the viewer if the run is watched."""
        print(f"begin {name}", flush=True)
        if self.watch is not None:
            self.watch.begin(f"{self.part}: {name}", about)

    def keep(self, record: rec.Record) -> None:
        """Write a record."""
        rec.write(record, self.out / f"{self.part}-{record.name}.json")

    def bag(self, name: str) -> str:
        """The path of a scenario's bag."""
        return str(self.out / f"{self.part}-{name}.bag")


def _serve_gazebo(stage: Stage) -> None:
    """For nodes that wait for Gazebo's services; the types exist if the submission was built on top of compat/."""
    try:
        from .gazebo import serve
    except ImportError:
        return
    serve(stage.loop)


def _server(job: Job, stage: Stage, grader_pids: Sequence[int]) -> None:
    server = ServerRun(job.plan, job.launch, stage, grader_pids)
    try:
        job.begin("start", "The node starts")
        start = server.start(job.bag("start"))
        job.keep(start)
        for index, scenario in enumerate(job.plan.scenarios, 1):
            if start.up and job.wanted(scenario.name):
                job.begin(scenario.name, scenario.about)
                job.keep(server.scenario(index, scenario, job.bag(scenario.name)))
    finally:
        server.close()


def _bridge(job: Job, stage: Stage, grader_pids: Sequence[int]) -> None:
    bridge = BridgeRun(job.plan, job.launch, stage, grader_pids)
    try:
        for name in BRIDGE_SCENARIOS:
            scenario = getattr(bridge, name)
            job.begin(name, scenario.__doc__)
            job.keep(scenario(job.bag(name)))
        for record in bridge.explained():
            job.keep(record)
    finally:
        bridge.close()


def _start_master() -> int:
    """Start a master at ROS_MASTER_URI, in this process's session, which the grader ends as a whole; its process id."""
    port = urlparse(os.environ["ROS_MASTER_URI"]).port
    master = child.start(["rosmaster", "--core", "-p", str(port)], start_new_session=False)
    deadline = time.monotonic() + MASTER_TIMEOUT
    while not rosgraph.is_master_online():
        if time.monotonic() > deadline:
            print(f"error no ROS master within {MASTER_TIMEOUT:g} s: is the machine too busy?", flush=True)
            sys.exit(1)
        time.sleep(0.02)
    return int(master.pid)


def main() -> None:
    """Usage: main JOB.json, with a free port in ROS_MASTER_URI."""
    job = Job(sys.argv[1])
    grader_pids = [os.getpid(), _start_master()]
    rospy.set_param("/use_sim_time", True)
    for name, value in job.parameters.items():
        rospy.set_param(name, value)
    # Without rosout, or the connection to its own log would be taken for the submission's (ServerRun._bring_up).
    rospy.init_node("robocop_sim", disable_rosout=True, disable_rostime=True, disable_signals=True, argv=[])
    stage = Stage(job.plan)
    _serve_gazebo(stage)
    stage.publish_clock()
    status = 0
    try:
        if job.viewer is not None:
            log = job.out / f"{job.part}-viewer.log"
            job.watch = stage.watch = Watch(stage.robot, PARAMS, job.plan, job.viewer, log)
            job.watch.open()
        (_server if job.part == "server" else _bridge)(job, stage, grader_pids)
    except GraderLostError as error:
        print(error, file=sys.stderr)
        status = 1
    except rospy.ROSException:  # publish() fails when a shutdown closes the topics during a tick
        if not shutdown_has_begun():
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
    os._exit(status)  # rospy's threads may still wait for a node that is gone


if __name__ == "__main__":
    main()
