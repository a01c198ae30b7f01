"""The floor under a case: its physics steps, ray casts and message bytes in a bare loop, in a process of its own."""

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

from .. import drive
from ..geometry import Pose2D, Twist2D, compose
from ..kinematics import Kinematics
from ..models import load_model
from ..nodes import convert
from ..params import SimParams, from_dict
from ..physics import Physics
from ..robot import RobotModel
from ..scanners import rounds_at
from ..sensors.lidar import Lidar
from ..simtime import due
from ..slice import Slice
from ..spawns import robots_from
from ..world import World, find_world, load_world
from .cases import ANGULAR, LINEAR, ODOM_RATE, SCAN_RATE, Case, parse_cases
from .frames import framed
from .results import Floor

PACKAGE = "aro_robocop_goto_as"


class Bare:
    """The parts of a simulator, and prebuilt messages."""

    def __init__(self, case: Case) -> None:
        p = from_dict(SimParams, case.params(0.0), case.name)
        share = rospkg.RosPack().get_path(PACKAGE)
        world = load_world(find_world(p.world, os.path.join(share, "worlds")))
        model = load_model(p.model, share)
        self.engine = (Physics(world, p.physics_rate, p.solver_iterations) if p.drive == "wheels"
                       else Kinematics(world, p.physics_rate, p.footprint_radius))
        for robot in robots_from(p, world, lambda _: model):
            self.engine.add_robot(robot.model, robot.spawn, p.wheel_torque)
        self.robots = range(case.robots)
        for robot in self.robots:
            self.engine.drive(robot, drive.wheel_speeds(Twist2D(LINEAR, ANGULAR), model.wheel_radius,
                                                        model.wheel_separation))
        spec = p.scanner().spec
        self._prepare_scans(world, model, Lidar(spec))
        stamp = convert.to_time(1)
        self.scan = _bytes(convert.to_scan(self.distances()[0].tolist(), spec, stamp, p.scan_frame))
        self.odom = _bytes(convert.to_odometry(Pose2D(), Twist2D(), stamp, p.odom_frame, p.base_frame, [0.0] * 36))

    def _prepare_scans(self, world: World, model: RobotModel, lidar: Lidar) -> None:
        self._lidar = lidar
        self._walls = Slice(world, model.scan_height)
        self._base_from_scan = model.base_from_scan.on_plane()
        # The others as they stand at the start: to gather them for each scan is not the rays' own work.
        poses = self._scanners()
        circles = np.column_stack([poses[:, :2], np.full(len(poses), rounds_at(model, model.scan_height)[0, 2])])
        others = [np.delete(circles, robot, axis=0) for robot in range(len(poses))]
        self._others = np.stack(others) if len(poses) > 1 else None

    def _scanners(self) -> np.ndarray:
        poses = [compose(self.engine.state(robot).world_from_base, self._base_from_scan) for robot in self.robots]
        return np.array([(pose.x, pose.y, pose.yaw) for pose in poses])

    def distances(self) -> np.ndarray:
        """Scans of all robots (n, beams) [m] from where they are now."""
        poses = self._scanners()
        return self._lidar.distances(poses, self._walls, self._others)


def _bytes(message: Any) -> bytes:
    buffer = BytesIO()
    message.serialize(buffer)
    return framed(buffer.getvalue())


def measure(case: Case, seconds: float, links: List[socket.socket]) -> Floor:
    """Go through simulated time for so many seconds of wall time; a scan and an odometry link for each robot."""
    bare, rate, clock = Bare(case), case.physics_rate, time.perf_counter
    stepping = scanning = sending = 0.0
    steps = scans = messages = 0
    cpu = -time.process_time()
    while stepping + scanning + sending < seconds or not scans:
        start = clock()
        bare.engine.step()
        stepping += clock() - start
        steps += 1
        kinds = []
        if due(steps, SCAN_RATE, rate):
            start = clock()
            bare.distances()
            scanning += clock() - start
            scans += case.robots
            kinds.append((bare.scan, links[:case.robots]))
        if due(steps, ODOM_RATE, rate):
            kinds.append((bare.odom, links[case.robots:]))
        start = clock()
        for message, receivers in kinds:
            for link in receivers:
                link.sendall(message)
            messages += len(receivers)
        sending += clock() - start
    cpu += time.process_time()
    wall, simulated = stepping + scanning + sending, steps / rate
    return Floor(simulated / wall, cpu / simulated, stepping / steps, scanning / scans, sending / messages)


def main(name: str, seconds: str, port: str) -> None:
    """Entry point of the process: a line of JSON."""
    (case,) = parse_cases([name])
    links = [socket.create_connection(("127.0.0.1", int(port))) for _ in case.topics()]
    print(json.dumps(asdict(measure(case, float(seconds), links))), flush=True)


if __name__ == "__main__":
    main(*sys.argv[1:])
