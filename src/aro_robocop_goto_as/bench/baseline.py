"""The baseline of a case: its simulator without ROS, which sends messages of the same number and size."""

import contextlib
import socket
import time
from io import BytesIO
from typing import Any, Dict

from nav_msgs.msg import Odometry
from sensor_msgs.msg import LaserScan

from ..geometry import Twist2D
from ..param_loading import from_dict
from ..ros.sim.loading import load_simulator
from ..sim_params import SimParams
from ..simulation.rates import ODOM, SCAN
from ..simulation.schedule import due
from .cases import ANGULAR, LINEAR, ODOM_RATE, SCAN_RATE, SCAN_SAMPLES, Case
from .client import Client


def framed(message: Any) -> bytes:
    """A message as it is sent over a connection: its length, then itself."""
    buffer = BytesIO()
    message.serialize(buffer)
    return len(buffer.getvalue()).to_bytes(4, "little") + buffer.getvalue()


def connection(client: Client, topic: str) -> socket.socket:
    """A connection over loopback, the other end of which the client reads."""
    with socket.create_server(("127.0.0.1", 0)) as server:
        link = socket.create_connection(server.getsockname())
        client.add(topic, server.accept()[0])
    return link


def measure_baseline(case: Case, world: str, seconds: float) -> Dict[str, float]:
    """Simulate for `seconds` of wall time in a world (name or path), with the client of a simulation.

    Returns the factor and, in microseconds, the wall times of a step of all robots, with their measurements, and of a
    message to one of them.
    """
    robots, clock = range(case.robots), time.perf_counter
    outgoing = [(SCAN_RATE, framed(LaserScan(ranges=[1.0] * SCAN_SAMPLES))), (ODOM_RATE, framed(Odometry()))]
    stepping = sending = 0.0
    steps = messages = 0
    with contextlib.ExitStack() as stack:
        simulator = load_simulator(from_dict(SimParams, case.params(0.0, world), case.name))
        stack.callback(simulator.close)
        client = stack.enter_context(Client())
        links = [stack.enter_context(connection(client, topic)) for topic in case.topics()]
        for robot in robots:
            simulator.command(Twist2D(LINEAR, ANGULAR), robot)
        while stepping + sending < seconds or not messages:
            start = clock()
            simulator.step({SCAN: robots, ODOM: robots})
            stepped = clock()
            steps += 1
            for first, (rate, message) in enumerate(outgoing):
                if due(steps, rate, case.physics_rate):
                    for link in links[first :: len(outgoing)]:
                        link.sendall(message)
                    messages += case.robots
            stepping += stepped - start
            sending += clock() - stepped
    return {
        "baseline": steps / case.physics_rate / (stepping + sending),
        "step_us": stepping / steps * 1e6,
        "message_us": sending / messages * 1e6,
    }
