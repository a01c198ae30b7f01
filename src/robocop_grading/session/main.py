"""Runs all scenarios of one part of a submission, and writes a record file for each."""

import contextlib
import os
import sys
from pathlib import Path
from urllib.parse import urlparse

import rospy

from aro_robocop_goto_as.errors import GraderLostError, NoTimeError, WatchError

from ..record import read
from ..runner import Job
from . import progress, ros_internals
from .bridge import BridgeRun
from .own_master import start_master
from .run import NODE_LOST, Run
from .server import ServerRun
from .stage import PARAMS, Stage
from .watch import Watch

REFUSAL = "the judge decides where the robot and the models of the world are"  # to calls of Gazebo's that change them


def _serve_gazebo(stage: Stage) -> None:
    """For nodes that wait for Gazebo's services; the types exist if the submission was built on top of compat/."""
    with contextlib.suppress(ImportError):
        from aro_robocop_goto_as.ros.sim.gazebo_services import GazeboServices

        GazeboServices(stage.simulation, None, REFUSAL)


def main() -> None:
    """Usage: main JOB, with a free port in ROS_MASTER_URI."""
    progress.start()
    job = read(Job, Path(sys.argv[1]))
    ros_internals.install()
    master = start_master(int(urlparse(os.environ["ROS_MASTER_URI"]).port or 0))
    if master is None:
        progress.tell("busy another program has taken the ROS master's port")
        sys.exit(1)
    ros_internals.update_at_once(master.handler)
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
        if not ros_internals.shutdown_has_begun():
            raise
        print(NODE_LOST, file=sys.stderr)
        status = 1
    except NoTimeError as error:
        progress.tell(f"busy {error}")
    except WatchError as error:
        progress.tell(f"error {error}")
        status = 1
    finally:
        run.close()
        stage.bag.close()  # of a scenario that was cut short
        if stage.watch is not None:
            stage.watch.close()
    sys.stdout.flush()
    sys.stderr.flush()
    os._exit(status)  # rospy's threads may still wait for a node that is gone


if __name__ == "__main__":
    main()
