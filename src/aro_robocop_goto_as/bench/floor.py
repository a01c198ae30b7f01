"""The floor of a case: a process that runs its physics steps, ray casts and message bytes in a bare loop."""

import json
import os
import socket
import sys
import time
from dataclasses import asdict
from io import BytesIO
from typing import Any, List

import numpy as np
import rospkg

from ..geometry import Pose2D, Twist2D
from ..param_loading import from_dict
from ..params import SimParams
from ..raycast.scanners import Scanners
from ..robot import base_controller
from ..robot.catalog import load_model
from ..ros import convert
from ..sensors.lidar import Lidar
from ..simulation.clock import due
from ..simulation.factory import make_engine
from ..simulation.robots import robots_from
from ..world.load import find_world, load_world
from .cases import ANGULAR, LINEAR, ODOM_RATE, SCAN_RATE, Case, parse_cases
from .frames import framed
from .results import Floor

PACKAGE = "aro_robocop_goto_as"


class Bare:
    """The simulator's engine and lidar, and serialised messages."""

    def __init__(self, case: Case) -> None:
        p = from_dict(SimParams, case.params(0.0), case.name)
        share = rospkg.RosPack().get_path(PACKAGE)
        world = load_world(find_world(p.world, os.path.join(share, "worlds")))
        model = load_model(p.model, share)
        self.engine = make_engine(p.engine(), world)
        for robot_spec in robots_from(p.spawn_params(), world, lambda _: model):
            self.engine.add_robot(robot_spec.model, robot_spec.spawn)
        self.robots = range(case.robots)
        for robot in self.robots:
            self.engine.set_wheel_speeds(
                robot,
                base_controller.wheel_speeds(Twist2D(LINEAR, ANGULAR), model.wheel_radius, model.wheel_separation),
            )
        spec = p.scanner().spec
        self._lidar, self._scanners = Lidar(spec), Scanners([model] * case.robots, world)
        stamp = convert.to_time(1)
        self.scan = _bytes(convert.to_scan(self.distances()[0], spec, stamp, p.scan_frame))
        self.odom = _bytes(convert.to_odometry(Pose2D(), Twist2D(), stamp, p.odom_frame, p.base_frame, [0.0] * 36))

    def distances(self) -> np.ndarray:
        """Scans of all robots from their present poses: (n, beams) [m]."""
        poses = [self.engine.state(robot).world_from_footprint for robot in self.robots]
        return self._scanners.distances(self._lidar.fan, self._lidar.spec.range_max, poses, self.robots, 0.0)


def _bytes(message: Any) -> bytes:
    buffer = BytesIO()
    message.serialize(buffer)
    return framed(buffer.getvalue())


def measure(case: Case, seconds: float, links: List[socket.socket]) -> Floor:
    """Simulate for `seconds` of wall time; `links`: first the scan connection of each robot, then the odometry ones."""
    bare, rate, clock = Bare(case), case.physics_rate, time.perf_counter
    stepping = scanning = sending = 0.0
    steps = scans = messages = 0
    cpu = -time.process_time()
    while stepping + scanning + sending < seconds or not scans:
        start = clock()
        bare.engine.step()
        stepping += clock() - start
        steps += 1
        outgoing = []
        if due(steps, SCAN_RATE, rate):
            start = clock()
            bare.distances()
            scanning += clock() - start
            scans += case.robots
            outgoing.append((bare.scan, links[: case.robots]))
        if due(steps, ODOM_RATE, rate):
            outgoing.append((bare.odom, links[case.robots :]))
        start = clock()
        for message, receivers in outgoing:
            for link in receivers:
                link.sendall(message)
            messages += len(receivers)
        sending += clock() - start
    cpu += time.process_time()
    wall, simulated = stepping + scanning + sending, steps / rate
    return Floor(simulated / wall, cpu / simulated, stepping / steps, scanning / scans, sending / messages)


def main(name: str, seconds: str, port: str) -> None:
    """Entry point of the process: prints a line of JSON."""
    (case,) = parse_cases([name])
    links = [socket.create_connection(("127.0.0.1", int(port))) for _ in case.topics()]
    print(json.dumps(asdict(measure(case, float(seconds), links))), flush=True)


if __name__ == "__main__":
    main(*sys.argv[1:])
