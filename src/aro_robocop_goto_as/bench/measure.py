"""A case, once: its simulation at a real-time factor -> Run, its bare parts -> Floor."""

import contextlib
import json
import os
import sys
import time
from pathlib import Path
from typing import Callable, Iterator

import rospy
from geometry_msgs.msg import Twist, Vector3

from ..errors import BenchError
from ..simtime import NANOSECONDS
from .cases import ANGULAR, LINEAR, Case
from .frames import deliveries
from .processes import Child, Client, running
from .results import Floor, Run

SETTLE = 0.3  # [s, wall] from the last connection to the first look
NODE = "/robocop_sim"


def simulate(case: Case, factor: float, seconds: float, simulator: str, directory: Path) -> Run:
    """Run a simulator and its client for so many seconds of wall time; BenchError when that goes wrong."""
    rospy.set_param(NODE, case.params(factor))
    topics = case.topics()
    with commands(case) as all_taken, running(
            Client(directory / "client.log", "--master", os.environ["ROS_MASTER_URI"], *topics)) as client:
        client.line()
        with running(Child("the simulator", [simulator], directory / "simulator.log")) as child:
            child.wait_until(lambda: len(client.tally().first_at) == len(topics) and all_taken(),
                             "messages of every topic, commands for every robot")
            time.sleep(SETTLE)
            before, cpu_before = client.tally(), child.cpu()
            time.sleep(seconds)
            after, cpu_after = client.tally(), child.cpu()
            child.check()
            memory = child.peak_memory()
        client.wait_until(lambda: client.tally().open == 0, "the end of every connection")
        last = client.tally()
    simulated = (after.newest_ns - before.newest_ns) / NANOSECONDS
    wall = after.time - before.time
    if simulated <= 0.0:
        raise BenchError(f"no simulated time went by in {wall:.1f} s")
    first_scan = min(at for topic, at in last.first_at.items() if topic.endswith("scan")) - child.started
    return Run(simulated / wall, (cpu_after - cpu_before) / simulated, memory, first_scan,
               *deliveries(last.counts, topics), (after.cpu - before.cpu) / wall)


def bare(case: Case, seconds: float, directory: Path) -> Floor:
    """Run the bare parts and their client for so many seconds of wall time; BenchError when that goes wrong."""
    with running(Client(directory / "client.log", "--listen")) as client:
        port = client.line().strip()
        command = [sys.executable, "-m", "aro_robocop_goto_as.bench.floor", case.name, str(seconds), port]
        with running(Child("the floor", command, directory / "floor.log", talk=True)) as child:
            return Floor(**json.loads(child.line()))


@contextlib.contextmanager
def commands(case: Case) -> Iterator[Callable[[], bool]]:
    """Tell every robot once to drive on and on; yields whether all have been told."""
    publishers = [rospy.Publisher(robot + "cmd_vel", Twist, latch=True, queue_size=1) for robot in case.namespaces]
    try:
        for publisher in publishers:
            publisher.publish(Twist(Vector3(LINEAR, 0.0, 0.0), Vector3(0.0, 0.0, ANGULAR)))
        yield lambda: all(publisher.get_num_connections() for publisher in publishers)
    finally:
        for publisher in publishers:
            publisher.unregister()
