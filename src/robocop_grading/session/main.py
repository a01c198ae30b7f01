"""Runs all scenarios of one part of a submission, and writes a record file for each."""

import contextlib
import os
import sys
import time
from pathlib import Path
from urllib.parse import urlparse

import rosgraph
import rospy

from aro_robocop_goto_as.errors import GraderLostError, NoTimeError, WatchError
from aro_robocop_goto_as.process import child
from aro_robocop_goto_as.ros.rospy_internals import shutdown_has_begun

from ..record import read
from ..runner import Job
from . import ros_internals
from .bridge import BridgeRun
from .run import NODE_LOST, Run
from .server import ServerRun
from .stage import PARAMS, Stage
from .watch import Watch

MASTER_TIMEOUT = 600.0  # [s, wall]
REFUSAL = "the judge decides where the robot and the models of the world are"  # to calls of Gazebo's that change them


def _serve_gazebo(stage: Stage) -> None:
    """For nodes that wait for Gazebo's services; the types exist if the submission was built on top of compat/."""
    with contextlib.suppress(ImportError):
        from aro_robocop_goto_as.ros.sim.gazebo_services import GazeboServices

        GazeboServices(stage.simulation, None, REFUSAL)


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
    job = read(Job, Path(sys.argv[1]))
    ros_internals.install()
    _start_master()
    rospy.set_param("/use_sim_time", True)
    # rospy asks the master for it with every line it logs, unless it is set.
    rospy.set_param("/rosout_disable_topics_generation", True)
    for name, value in job.parameters.items():
        rospy.set_param(name, value)
    # Without rosout, or the connection to its own log would be taken for the submission's (ServerRun._bring_up).
    rospy.init_node("robocop_sim", disable_rosout=True, disable_rostime=True, disable_signals=True, argv=[])
    stage = Stage(job.plan)
    _serve_gazebo(stage)
    stage.publish_clock()
    run: Run = (ServerRun if job.part == "server" else BridgeRun)(job, stage)
    status = 0
    try:
        if job.viewer is not None:
            log = job.out / f"{job.part}-viewer.log"
            stage.watch = Watch(stage.robot, PARAMS, job.plan, job.viewer, log)
            stage.watch.open()
        run.scenarios()
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
        run.close()
        if stage.watch is not None:
            stage.watch.close()
    sys.stdout.flush()
    sys.stderr.flush()
    os._exit(status)  # rospy's threads may still wait for a node that is gone


if __name__ == "__main__":
    main()
