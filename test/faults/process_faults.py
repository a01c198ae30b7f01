"""Faults of processes: frozen, killed, replaced by a second one."""

import signal
import time

from faults import ANY, DONE, STOPPED, drive, fault
from system import BRIDGE, SIMULATOR, is_connected, wait_for

FROZEN = 30.0  # [s, wall] longer than every timeout of the other nodes
NO_DATA = ("NO_ODOM", "NO_SCAN")


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
