"""The simulation of a case at a real-time factor -> Run."""

import signal
import sys
import time
from dataclasses import dataclass
from pathlib import Path
from subprocess import Popen
from typing import Any, Dict

from systems import System
from waiting import wait_for

from aro_robocop_goto_as.geometry import NANOSECONDS

from . import BenchError
from .cases import Case
from .checkouts import Checkout
from .client import Client

SETTLE = 0.3  # [s, wall] from the last connection to the start of the measurement
CPU_CLOCK = 2  # CPUCLOCK_SCHED, of which clock_getcpuclockid makes a process's clock in Linux


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


def simulate(case: Case, factor: float, seconds: float, checkout: Checkout, ros: System) -> Run:
    """Run a checkout's simulator and a client for `seconds` of wall time; BenchError when one of them fails."""
    ros.master.setParam("/robocop_sim", case.params(factor))
    ros.master.setParam("/use_sim_time", case.lockstep)
    before = [process for process, _ in ros.running]
    try:
        with Client(case.topics(), ros.directory, ros.uri) as client:
            return _run(case, seconds, checkout, ros, client)
    finally:
        ros.end_all(*before)


def _run(case: Case, seconds: float, checkout: Checkout, ros: System, client: Client) -> Run:
    processes: Dict[str, Popen[bytes]] = {}
    if case.kind == "server":
        processes["the server"] = _node("robocop_goto_as.py", checkout, ros)
    program = Path(__file__).with_name("controllers.py")
    arguments = [case.kind] if case.lockstep else case.namespaces
    control = processes["the controller"] = ros.start("controller", sys.executable, program, *arguments)
    _wait(lambda: _says(control, "ready"), "the controller's start", processes)
    started = time.monotonic()
    simulator = processes["the simulator"] = _node("robocop_sim.py", checkout, ros)
    ready = "messages on every topic and control of every robot"
    _wait(lambda: client.reads_all() and _says(control, "running"), ready, processes)
    time.sleep(SETTLE)
    start, stamp, cpu, client_cpu = time.monotonic(), client.newest_ns, _cpu(simulator), client.cpu
    time.sleep(seconds)
    wall, simulated = time.monotonic() - start, (client.newest_ns - stamp) / NANOSECONDS
    _require_running(processes)
    cpu, client_cpu, memory = _cpu(simulator) - cpu, client.cpu - client_cpu, _peak_memory(simulator)
    simulator.end(signal.SIGINT)
    expected, delivered = client.deliveries()
    if simulated <= 0.0:
        raise BenchError(f"simulated time did not advance in {wall:.1f} s")
    first_scan = client.first_scan_at() - started
    return Run(simulated / wall, cpu / simulated, memory, first_scan, expected, delivered, client_cpu / wall)


def _node(program: str, checkout: Checkout, ros: System) -> "Popen[bytes]":
    return ros.start(program, checkout.programs / program, env=checkout.environment(ros.environment))


def _says(process: Any, word: str) -> bool:
    """Whether a process has printed this word on a line of its own."""
    return word in process.output.split("\n")


def _require_running(processes: Dict[str, Any]) -> None:
    for name, process in processes.items():
        if process.poll() is not None:
            said = process.output.strip() or "its log is empty"
            raise BenchError(f"{name} ended with status {process.poll()}: {said.splitlines()[-1]}")


def _wait(condition: Any, what: str, processes: Dict[str, Any]) -> None:
    """Wait for a condition; BenchError when a process ends or it takes too long."""

    def holds() -> bool:
        _require_running(processes)
        return bool(condition())

    wait_for(holds, what, poll=0.02, error=BenchError)


def _cpu(process: "Popen[bytes]") -> float:
    """Processor time [s] of all threads, user and system, to the nanosecond (psutil: to a tick of 10 ms)."""
    return time.clock_gettime(~process.pid << 3 | CPU_CLOCK)


def _peak_memory(process: "Popen[bytes]") -> int:
    """Peak resident memory [bytes], which psutil does not have on Linux."""
    status = Path(f"/proc/{process.pid}/status").read_text().split()
    return int(status[status.index("VmHWM:") + 1]) * 1024
