"""The simulation of a case at a real-time factor -> Run."""

import contextlib
import sys
import time
from dataclasses import dataclass
from pathlib import Path
from typing import Iterator

import rosgraph

from aro_robocop_goto_as.simulation.schedule import NANOSECONDS

from . import BenchError
from .cases import Case
from .client import Client
from .processes import Checkout, Child

SETTLE = 0.3  # [s, wall] from the last connection to the start of the measurement


@dataclass(frozen=True)
class Run:
    """The result of one simulation."""

    factor: float  # simulated seconds per second of the wall clock
    cpu: float  # [s] of processor time per simulated second, user and system
    memory: int  # [bytes] peak
    first_scan: float  # [s, wall] from the process's start to the first scan
    expected: int  # messages, from simulated time and rates
    delivered: int
    client_busy: float  # share of a processor; near 1 the client limits the speed


def simulate(case: Case, factor: float, seconds: float, checkout: Checkout, directory: Path) -> Run:
    """Run a checkout's simulator and a client for `seconds` of wall time; BenchError when one of them fails."""
    master = rosgraph.Master("/robocop_bench")
    master.setParam("/robocop_sim", case.params(factor))
    master.setParam("/use_sim_time", case.lockstep)
    with controller(case, checkout, directory) as control, Client(case.topics(), directory) as client:
        with _node("the simulator", "robocop_sim.py", checkout, directory) as simulator:
            ready = "messages on every topic and control of every robot"
            simulator.wait_until(lambda: client.reads_all() and control.says("running"), ready)
            time.sleep(SETTLE)
            start, stamp, cpu, client_cpu = time.monotonic(), client.newest_ns, simulator.cpu(), client.cpu
            time.sleep(seconds)
            wall, simulated = time.monotonic() - start, (client.newest_ns - stamp) / NANOSECONDS
            cpu, client_cpu = simulator.cpu() - cpu, client.cpu - client_cpu
            simulator.require_running()
            memory = simulator.peak_memory()
        expected, delivered = client.deliveries()
    if simulated <= 0.0:
        raise BenchError(f"simulated time did not advance in {wall:.1f} s")
    first_scan = client.first_scan_at() - simulator.started
    return Run(simulated / wall, cpu / simulated, memory, first_scan, expected, delivered, client_cpu / wall)


def _node(name: str, program: str, checkout: Checkout, directory: Path) -> Child:
    return Child(name, [str(checkout.programs / program)], directory / f"{program}.log", checkout.environment())


@contextlib.contextmanager
def controller(case: Case, checkout: Checkout, directory: Path) -> Iterator[Child]:
    """What controls the robots of a case: a process that prints "running" when it does."""
    with contextlib.ExitStack() as processes:
        if case.kind == "server":
            processes.enter_context(_node("the server", "robocop_goto_as.py", checkout, directory))
        program = [sys.executable, str(Path(__file__).with_name("controllers.py"))]
        command = [*program, *([case.kind] if case.lockstep else case.namespaces)]
        control = processes.enter_context(Child("the controller", command, directory / "controller.log"))
        control.wait_until(lambda: control.says("ready"), "the controller's start")
        yield control
