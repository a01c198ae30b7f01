"""Faults of processes: frozen, killed, replaced by a second one, without room for their logs."""

import contextlib
import math
import os
import signal
import subprocess
import time
from pathlib import Path

from faults import ANY, DONE, STOPPED, drive, fault
from processes import processes_with
from system import BRIDGE, SIMULATOR, is_connected, wait_for

from aro_robocop_goto_as.process.ports import free_port

FROZEN = 30.0  # [s, wall] longer than every timeout of the other nodes
LAUNCHER_LIFE = 6.0  # [s, wall] at most, from the first process of a system to the end of its launcher
MARK = "FAULT_LAUNCHER"  # environment variable of all processes of a launcher
NO_DATA = ("NO_ODOM", "NO_SCAN")
ROBOCOP = Path(__file__).resolve().parents[2] / "robocop"


@fault("process")
def server_frozen(e):
    """SIGSTOP, then SIGCONT, of the server during a goal."""
    goal = drive(e)
    e.system.send_signal(e.client.server, signal.SIGSTOP)
    try:
        if e.rng.random() < 0.5:
            e.client.cancel(goal)
        time.sleep(e.rng.uniform(0.0, 0.05))
    finally:
        e.system.send_signal(e.client.server, signal.SIGCONT)
    return (*STOPPED, *NO_DATA)


@fault("process", costly=True)
def server_frozen_long(e):
    """The server is frozen for 30 s during a goal, while time goes on."""
    drive(e)
    e.system.send_signal(e.client.server, signal.SIGSTOP)
    try:
        e.stage.pass_wall_time(FROZEN)
    finally:
        e.system.send_signal(e.client.server, signal.SIGCONT)
    e.stage.prepare()  # the simulator may have disconnected it
    return (*STOPPED, *NO_DATA, "STUCK")


@fault("process", costly=True)
def server_killed(e):
    """SIGKILL of the server during a goal."""
    drive(e)
    e.client.lose_goals()
    _replace_server(e, signal.SIGKILL)
    return (*STOPPED, "OBSTACLE")


@fault("process", costly=True)
def server_told_to_end(e):
    """SIGTERM of the server during a goal."""
    goal = drive(e)
    e.system.end(e.client.server, signal.SIGTERM)
    wait_for(lambda: e.client.results[goal], "the result SHUTDOWN of a server that ends")
    _replace_server(e, None)
    return ("REACHED", "SHUTDOWN")


def _replace_server(e, number):
    server = e.client.server
    if number is not None:
        e.system.end(server, number)
    e.stage.require_rest_without_server()
    e.system.restart(server)
    e.stage.prepare()


@fault("process", needs="simulator")
def simulator_frozen(e):
    """SIGSTOP, then SIGCONT, of the simulator during a goal."""
    drive(e)
    e.system.send_signal("/" + SIMULATOR, signal.SIGSTOP)
    time.sleep(e.rng.uniform(0.0, 0.1))
    e.system.send_signal("/" + SIMULATOR, signal.SIGCONT)
    return (*STOPPED, *NO_DATA)


@fault("process", needs="simulator", costly=True)
def simulator_ended(e):
    """SIGKILL or SIGTERM of the simulator during a goal, which goes on with the next one."""
    drive(e)
    e.system.end("/" + SIMULATOR, e.rng.choice((signal.SIGKILL, signal.SIGTERM)))
    e.stage.now = 0.0
    for client in e.clients:
        client.odom = None
    e.system.restart("/" + SIMULATOR)
    e.stage.prepare()
    for client in e.clients:
        client.restart_time()
    return ANY


@fault("process", costly=True)
def bridge_ended(e):
    """SIGKILL or SIGTERM of the bridge during a goal."""
    drive(e)
    bridge = "/" + BRIDGE
    if bridge in e.system.processes:
        e.system.end(bridge, e.rng.choice((signal.SIGKILL, signal.SIGTERM)))
        e.system.restart(bridge)
        wait_for(lambda: is_connected(e.client.click_topic, bridge), "the bridge listens again")
    return DONE


@fault("process", costly=True)
def second_server(e):
    """A second server of the same name takes over during a goal."""
    drive(e)
    e.client.lose_goals()
    e.system.take_over(e.client.server)
    e.stage.require_rest_without_server()
    e.stage.prepare()
    return (*STOPPED, "SHUTDOWN")


@fault("process")
def log_full(e):
    """No room for the logs during several goals."""
    nodes = [node for node in (e.client.server, "/" + BRIDGE) if node in e.system.processes]
    for node in nodes:
        e.system.limit_files(node, 0)
    try:
        e.client.send(math.nan, 0.0)
        e.stage.wait_for(e.client.all_ended, "the end of an impossible goal without room for the log")
        e.client.send_near(e.rng)
        e.stage.wait_for(e.client.all_ended, "the goal's end without room for the log")
    finally:
        for node in nodes:
            e.system.limit_files(node, None)
    return ("BAD_GOAL", "REACHED")


@fault("process", costly=True)
def log_full_from_the_start(e):
    """A server starts whose standard output and log are on a full disk."""
    server = e.client.server
    e.system.end(server, signal.SIGTERM)
    e.stage.require_rest_without_server()
    try:
        e.system.start(server, "__log:=/dev/full", output="/dev/full")
        e.stage.prepare()
        for _ in range(2):
            e.client.send_near(e.rng)
            e.stage.wait_for(e.client.all_ended, "the goal's end without room for the log")
        e.system.end(server, signal.SIGTERM)
    finally:
        e.system.kill(server)
    e.stage.require_rest_without_server()
    e.system.restart(server)
    e.stage.prepare()
    return DONE


@fault("process", costly=True)
def server_on_wall_time(e):
    """A server starts while /use_sim_time is false, so its clock is not the simulator's."""
    server = e.client.server
    e.system.end(server, signal.SIGTERM)
    e.stage.require_rest_without_server()
    e.system.master.setParam("/use_sim_time", False)
    try:
        e.system.restart(server)
        e.client.wait_for_server()
        e.client.send_near(e.rng)
        time.sleep(e.rng.uniform(0.0, 1.0))
    finally:
        e.system.master.setParam("/use_sim_time", True)
    e.client.lose_goals()
    _replace_server(e, signal.SIGTERM)
    return ANY


@fault("process", needs="lab", costly=True)
def launcher_killed(e):
    """SIGKILL of the launcher that started the server, during a goal."""
    server = e.client.server
    e.system.end(server, signal.SIGTERM)
    launcher = _Launcher(e, "run", "sim:=false", "bridge:=false", "rviz:=false")
    try:
        e.stage.wait_for_server()
        drive(e)
        e.client.lose_goals()
        launcher.kill()
    finally:
        launcher.close()
    e.stage.require_rest_without_server()
    e.system.restart(server)
    e.stage.prepare()
    return (*STOPPED, "SHUTDOWN")


@fault("process", costly=True)
def launcher_of_another_killed(e):
    """SIGKILL of the launcher of another system, which it may still be starting."""
    drive(e)
    command = e.rng.choice((("run", "rviz:=false"), ("sim",), ("goto", "0.3", "0.0")))
    launcher = _Launcher(e, *command, master_port=free_port())
    try:
        wait_for(lambda: launcher.processes("robocop_sim.py"), f"{command} starts a simulator")
        time.sleep(e.rng.uniform(0.0, LAUNCHER_LIFE))
        launcher.kill()
    finally:
        launcher.close()
    return DONE


class _Launcher:
    """A ./robocop command that starts a system."""

    def __init__(self, e, *command, master_port=None):
        self._mark = f"{os.getpid()}/{e.name}"
        self._command = command
        environment = {**os.environ, MARK: self._mark}
        environment.update({"ROS_MASTER_URI": f"http://localhost:{master_port}"} if master_port else {})
        log = open(e.system.folder / "launcher.log", "ab")
        with log:
            self._process = subprocess.Popen(
                [ROBOCOP, *command],
                env=environment,
                stdin=subprocess.DEVNULL,
                stdout=log,
                stderr=log,
                start_new_session=True,
            )

    def processes(self, word=""):
        """Ids of its processes with this word on their command line."""
        return processes_with(f"{MARK}={self._mark}".encode(), word.encode())

    def kill(self):
        """SIGKILL; all that it has started has to end."""
        self._process.kill()
        self._process.wait()
        wait_for(lambda: not self.processes(), self._left)

    def _left(self):
        names = {pid: " ".join(Path(f"/proc/{pid}/cmdline").read_text().split("\0")[:3]) for pid in self.processes()}
        return f"the end of all processes that {self._command} had started: {names}"

    def close(self):
        """Kill what is left of it."""
        for pid in self.processes():
            with contextlib.suppress(ProcessLookupError):
                os.kill(pid, signal.SIGKILL)
        self._process.wait()
