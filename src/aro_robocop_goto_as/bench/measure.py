"""One repeat of a case: its simulation at a real-time factor -> Run, its bare parts -> Floor."""

import contextlib
import json
import os
import sys
import time
from pathlib import Path
from typing import Callable, Iterator, Mapping, Optional

import rospy
from geometry_msgs.msg import Twist, Vector3

from ..errors import BenchError
from ..simulation.clock import NANOSECONDS
from .cases import ANGULAR, LINEAR, Case
from .frames import deliveries
from .processes import Child, Client, running
from .results import Floor, Run

SETTLE = 0.3  # [s, wall] from the last connection to the start of the measurement
NODE = "/robocop_sim"


Environment = Optional[Mapping[str, str]]  # None: that of this process


def simulate(
    case: Case, factor: float, seconds: float, programs: Path, directory: Path, environment: Environment = None
) -> Run:
    """Run a simulator and its client for `seconds` of wall time; BenchError when one of them fails.

    `programs` is the folder of robocop_sim.py and robocop_goto_as.py; their environment may be another checkout's.
    """
    rospy.set_param(NODE, case.params(factor))
    rospy.set_param("/use_sim_time", bool(case.controller))
    topics = case.topics()
    with velocity_commands(case) as all_connected, running(
        Client(directory / "client.log", "--master", os.environ["ROS_MASTER_URI"], *topics)
    ) as client:
        client.line()
        with running(
            Child("the simulator", [str(programs / "robocop_sim.py")], directory / "simulator.log", False, environment)
        ) as child, controller(case, programs, directory, environment):
            child.wait_until(
                lambda: len(client.tally().first_at) == len(topics) and all_connected(),
                "messages on every topic and commands for every robot",
            )
            time.sleep(SETTLE)
            before, cpu_before = client.tally(), child.cpu()
            time.sleep(seconds)
            after, cpu_after = client.tally(), child.cpu()
            child.require_running()
            memory = child.peak_memory()
        client.wait_until(lambda: client.tally().open == 0, "the end of all connections")
        last = client.tally()
    simulated = (after.newest_ns - before.newest_ns) / NANOSECONDS
    wall = after.time - before.time
    if simulated <= 0.0:
        raise BenchError(f"simulated time did not advance in {wall:.1f} s")
    first_scan = min(at for topic, at in last.first_at.items() if topic.endswith("scan")) - child.started
    return Run(
        simulated / wall,
        (cpu_after - cpu_before) / simulated,
        memory,
        first_scan,
        *deliveries(last.counts, topics),
        (after.cpu - before.cpu) / wall,
    )


def measure_floor(case: Case, seconds: float, directory: Path) -> Floor:
    """Run the bare parts and their client for `seconds` of wall time; BenchError when one of them fails."""
    with running(Client(directory / "client.log", "--listen")) as client:
        port = client.line().strip()
        command = [sys.executable, "-m", "aro_robocop_goto_as.bench.floor", case.name, str(seconds), port]
        with running(Child("the floor", command, directory / "floor.log", piped=True)) as child:
            return Floor(**json.loads(child.line()))


@contextlib.contextmanager
def controller(case: Case, programs: Path, directory: Path, environment: Environment) -> Iterator[None]:
    """The controller of a lockstep case, in control of the robot; nothing for other cases."""
    modules = {"rospy": "rospy_loop", "server": "goal_loop"}
    with contextlib.ExitStack() as processes:
        if case.controller == "server":
            server = Child(
                "the server", [str(programs / "robocop_goto_as.py")], directory / "s.log", False, environment
            )
            processes.enter_context(running(server))
        if case.controller:
            command = [sys.executable, "-m", f"aro_robocop_goto_as.bench.{modules[case.controller]}"]
            loop = processes.enter_context(
                running(Child("the controller", command, directory / "controller.log", piped=True))
            )
            loop.line()
        yield


@contextlib.contextmanager
def velocity_commands(case: Case) -> Iterator[Callable[[], bool]]:
    """Publish one latched velocity command for every robot; yields a function: whether all are connected.

    In a lockstep case its controller does that.
    """
    if case.controller:
        yield lambda: True
        return
    publishers = [rospy.Publisher(robot + "cmd_vel", Twist, latch=True, queue_size=1) for robot in case.namespaces]
    try:
        for publisher in publishers:
            publisher.publish(Twist(Vector3(LINEAR, 0.0, 0.0), Vector3(0.0, 0.0, ANGULAR)))
        yield lambda: all(publisher.get_num_connections() for publisher in publishers)
    finally:
        for publisher in publishers:
            publisher.unregister()
