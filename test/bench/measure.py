"""A case is simulated by a checkout's programs as fast as possible and at real time -> figures."""

import os
import signal
import subprocess
import sys
import time
from pathlib import Path
from typing import Any, Dict, Mapping

from systems import System
from waiting import wait_for

from aro_robocop_goto_as.geometry import NANOSECONDS

from . import BenchError
from .cases import Case
from .client import Client

SETUP_TIMEOUT = 1800.0  # [s, wall] for `./robocop shell` of the other checkout, which may have to build it first
SETTLE = 0.3  # [s, wall] from the last connection to the start of the measurement
OF_SYSTEM = ("ROS_MASTER_URI", "ROS_HOSTNAME", "ROS_HOME", "ROS_LOG_DIR")  # not of the checkout's workspace
CPU_CLOCK = 2  # CPUCLOCK_SCHED, of which clock_getcpuclockid makes a process's clock in Linux
Figures = Dict[str, float]


def other_checkout(root: Path) -> Dict[str, str]:
    """The environment of a checkout's workspace, as its own `./robocop shell` sets it up; BenchError if it can't."""
    command = [str(root.absolute() / "robocop"), "shell", "env", "-0"]
    own = os.environ["ROBOCOP_STATE"] + os.sep  # what this checkout's workspace has added to paths is left out
    clean = {}
    for name, value in os.environ.items():
        parts = [part for part in value.split(":") if not part.startswith(own)]
        if parts and not name.startswith("ROBOCOP_"):
            clean[name] = ":".join(parts)
    try:
        answer = subprocess.check_output(command, env=clean, stdin=subprocess.DEVNULL, text=True, timeout=SETUP_TIMEOUT)
    except (OSError, subprocess.SubprocessError) as error:
        raise BenchError(f"--against {root}: expected a checkout of this project: {error}") from error
    variables = dict(entry.split("=", 1) for entry in answer.split("\0") if "=" in entry)
    if "ROBOCOP_WS" not in variables:
        raise BenchError(f"--against {root}: its ./robocop shell does not set ROBOCOP_WS")
    return variables


def measure(case: Case, seconds: float, checkout: Mapping[str, str], ros: System) -> Figures:
    """The figures of a repeat, which has a run as fast as possible and one at real time; BenchError if one fails."""
    fastest, paced = (_simulate(case, factor, seconds, checkout, ros) for factor in (0.0, 1.0))
    return {
        "factor": fastest["factor"],
        "cpu_ms": paced["cpu_ms"],
        "memory_mb": max(fastest["memory_mb"], paced["memory_mb"]),
        "first_scan_s": paced["first_scan_s"],
        "client_busy": fastest["client_busy"],
        "messages": fastest["messages"] + paced["messages"],
        "lost": fastest["lost"] + paced["lost"],
        "paced_factor": paced["factor"],
    }


def _simulate(case: Case, factor: float, seconds: float, checkout: Mapping[str, str], ros: System) -> Figures:
    """Run a checkout's simulator and a client for `seconds` of wall time."""
    ros.master.setParam("/robocop_sim", case.params(factor))
    ros.master.setParam("/use_sim_time", case.lockstep)
    before = [process for process, _ in ros.running]
    try:
        with Client(case.topics(), ros.uri) as client:
            return _run(case, seconds, checkout, ros, client)
    finally:
        ros.end_all(*before)


def _run(case: Case, seconds: float, checkout: Mapping[str, str], ros: System, client: Client) -> Figures:
    programs = Path(checkout["ROBOCOP_WS"], "lib", "aro_robocop_goto_as")
    environment = {**checkout, **{name: ros.environment[name] for name in OF_SYSTEM}}
    processes: Dict[str, Any] = {}

    def node(program: str) -> Any:
        return ros.start(program, programs / program, env=environment)

    def wait(condition: Any, what: str) -> None:
        wait_for(lambda: _require_running(processes) or condition(), what, poll=0.02, error=BenchError)

    if case.kind == "server":
        processes["the server"] = node("robocop_goto_as.py")
    program = Path(__file__).with_name("controllers.py")
    arguments = [case.kind] if case.lockstep else case.namespaces
    control = processes["the controller"] = ros.start("controller", sys.executable, program, *arguments)
    wait(lambda: "ready" in control.output.split("\n"), "the controller's start")
    started = time.monotonic()
    simulator = processes["the simulator"] = node("robocop_sim.py")
    ready = "messages on every topic and control of every robot"
    wait(lambda: client.reads_all() and "running" in control.output.split("\n"), ready)
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
    return {
        "factor": simulated / wall,  # simulated seconds per second of the wall clock
        "cpu_ms": cpu / simulated * 1e3,  # per simulated second, user and system
        "memory_mb": memory / 1e6,  # peak
        "first_scan_s": client.first_scan_at() - started,  # [s, wall] from the process's start
        "messages": delivered,
        "lost": expected - delivered,  # expected: from simulated time and rates
        "client_busy": client_cpu / wall,  # share of a processor; near 1 the client limits the speed
    }


def _require_running(processes: Dict[str, Any]) -> None:
    for name, process in processes.items():
        if process.poll() is not None:
            said = process.output.strip() or "its log is empty"
            raise BenchError(f"{name} ended with status {process.poll()}: {said.splitlines()[-1]}")


def _cpu(process: "subprocess.Popen[bytes]") -> float:
    """Processor time [s] of all threads, user and system, to the nanosecond (psutil: to a tick of 10 ms)."""
    return time.clock_gettime(~process.pid << 3 | CPU_CLOCK)


def _peak_memory(process: "subprocess.Popen[bytes]") -> int:
    """Peak resident memory [bytes], which psutil does not have on Linux."""
    status = Path(f"/proc/{process.pid}/status").read_text().split()
    return int(status[status.index("VmHWM:") + 1]) * 1024
