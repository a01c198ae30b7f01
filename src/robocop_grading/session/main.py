"""Runs all scenarios of one part of a submission, and writes a record file for each."""

import os
import sys
import time
from urllib.parse import urlparse

import rosgraph
import rospy

from aro_robocop_goto_as.errors import GraderLostError, NoTimeError, WatchError
from aro_robocop_goto_as.process import child
from aro_robocop_goto_as.ros.rospy_internals import shutdown_has_begun

from .. import record as rec
from ..job import Job
from ..plan import BRIDGE_SCENARIOS
from . import ros_internals
from .bridge import BridgeRun
from .node import Node
from .run import NODE_LOST
from .server import ServerRun
from .stage import PARAMS, Stage
from .watch import Watch

MASTER_TIMEOUT = 600.0  # [s, wall]


class Session:
    """A job while it is done."""

    def __init__(self, job: Job, stage: Stage) -> None:
        self.job, self.stage = job, stage

    def launch(self, stage: Stage) -> Node:
        """Start the node that is graded."""
        master = urlparse(os.environ["ROS_MASTER_URI"]).port
        return Node(
            self.job.command,
            self.job.environment,
            self.job.folder,
            lambda line: stage.post("line", line),
            stage.run_jobs,
            int(master or 0),
            stage.sim.stamp_ns,
        )

    def begin(self, name: str, about: str) -> None:
        """Announce the next scenario to the grader, and in the viewer if the run is watched."""
        print(f"begin {name}", flush=True)
        if self.stage.watch is not None:
            self.stage.watch.begin(f"{self.job.part}: {name}", about)

    def keep(self, record: rec.Record) -> None:
        """Write a record."""
        rec.write(record, self.job.out / f"{self.job.part}-{record.name}.json")

    def bag(self, name: str) -> str:
        """The path of a scenario's bag."""
        return str(self.job.out / f"{self.job.part}-{name}.bag")

    def serve_goals(self) -> None:
        """Run the server's scenarios."""
        job = self.job
        server = ServerRun(job.plan, self.launch, self.stage)
        try:
            self.begin("start", "The node starts")
            start = server.start(self.bag("start"))
            self.keep(start)
            for index, scenario in enumerate(job.plan.scenarios, 1):
                if start.up and job.plan.examines(job.part, scenario.name):
                    self.begin(scenario.name, scenario.about)
                    self.keep(server.scenario(index, scenario, self.bag(scenario.name)))
        finally:
            server.close()

    def click(self) -> None:
        """Run the bridge's scenarios."""
        bridge = BridgeRun(self.job.plan, self.launch, self.stage)
        try:
            wanted = [name for name in BRIDGE_SCENARIOS if self.job.plan.examines(self.job.part, name)]
            for name in BRIDGE_SCENARIOS[: BRIDGE_SCENARIOS.index(wanted[-1]) + 1]:  # each begins where one has ended
                scenario = getattr(bridge, name)
                self.begin(name, scenario.__doc__)
                self.keep(scenario(self.bag(name)))
        finally:
            bridge.close()


def _serve_gazebo(stage: Stage) -> None:
    """For nodes that wait for Gazebo's services; the types exist if the submission was built on top of compat/."""
    try:
        from .gazebo import serve
    except ImportError:
        return
    serve(stage.simulation)


def _start_master() -> None:
    """Start a master at ROS_MASTER_URI, in this process's session, which the grader ends as a whole."""
    port = urlparse(os.environ["ROS_MASTER_URI"]).port
    child.start(["rosmaster", "--core", "-p", str(port)], start_new_session=False)
    deadline = time.monotonic() + MASTER_TIMEOUT
    while not rosgraph.is_master_online():
        if time.monotonic() > deadline:
            print(f"busy no ROS master within {MASTER_TIMEOUT:g} s", flush=True)
            sys.exit(1)
        time.sleep(0.02)


def main() -> None:
    """Usage: main JOB, with a free port in ROS_MASTER_URI."""
    job = Job.read(sys.argv[1])
    ros_internals.install()
    _start_master()
    rospy.set_param("/use_sim_time", True)
    for name, value in job.parameters.items():
        rospy.set_param(name, value)
    # Without rosout, or the connection to its own log would be taken for the submission's (ServerRun._bring_up).
    rospy.init_node("robocop_sim", disable_rosout=True, disable_rostime=True, disable_signals=True, argv=[])
    stage = Stage(job.plan)
    _serve_gazebo(stage)
    stage.publish_clock()
    session = Session(job, stage)
    status = 0
    try:
        if job.viewer is not None:
            log = job.out / f"{job.part}-viewer.log"
            stage.watch = Watch(stage.robot, PARAMS, job.plan, job.viewer, log)
            stage.watch.open()
        (session.serve_goals if job.part == "server" else session.click)()
    except GraderLostError as error:
        print(error, file=sys.stderr)
        status = 1
    except rospy.ROSException:  # publish() fails when a shutdown closes the topics during a tick
        if not shutdown_has_begun():
            raise
        print(NODE_LOST, file=sys.stderr)
        status = 1
    except NoTimeError as error:
        print(f"busy {error}")
    except WatchError as error:
        print(f"error {error}")
        status = 1
    finally:
        if stage.watch is not None:
            stage.watch.close()
    sys.stdout.flush()
    sys.stderr.flush()
    os._exit(status)  # rospy's threads may still wait for a node that is gone


if __name__ == "__main__":
    main()
