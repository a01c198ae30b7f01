"""A program that scans, drives and sends messages with sanitized libraries; a finding ends the process."""

import math
import os
import socket
import sys
from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
from scenes import cut_of
from support import model_named

from aro_robocop_goto_as import compiled
from aro_robocop_goto_as.geometry import Pose2D, Pose3D
from aro_robocop_goto_as.physics.kinematic import KinematicEngine
from aro_robocop_goto_as.raycast.beams import Fan, ScanPlane, Scene
from aro_robocop_goto_as.raycast.grid_index import Tiles
from aro_robocop_goto_as.robot.base_controller import Limits
from aro_robocop_goto_as.robot.fleet import Fleet
from aro_robocop_goto_as.ros.publishing.batch import Batch
from aro_robocop_goto_as.ros.publishing.packed import counter
from aro_robocop_goto_as.ros.publishing.subscriber_link import SubscriberLink
from aro_robocop_goto_as.ros.sim.sensor_messages import (
    NO_VARIANCES,
    packed_clock,
    packed_imu,
    packed_joint_state,
    packed_odometry,
    packed_scan,
    packed_transforms,
)
from aro_robocop_goto_as.sensors.imu import ImuParams
from aro_robocop_goto_as.sensors.lidar import Lidar
from aro_robocop_goto_as.sensors.noise_streams import Episode
from aro_robocop_goto_as.sensors.odometry import Odometers, OdometryParams
from aro_robocop_goto_as.sensors.scan_profiles import PROFILES
from aro_robocop_goto_as.world.model import Box, Cylinder, Obstacle, World
from aro_robocop_goto_as.world.scripted_motion import Motion

FANS = [
    (0.0, 6.28319 / 359, 360),
    (-math.pi, math.pi / 180, 361),
    (-9.0, 0.1, 190),
    (1.0, 0.05, 20),
    (3.0, 1.0, 1),
    (0.0, 1e-300, 3),
    (0.0, 1e-9, 50),
    (-1e15, 5.0, 7),
]
PLACES = [0.0, 0.25, -1.0, 2.0, 1e-300, -1e-12, 50.0, 1e9, -1e200, 1e308]


def scans(random: np.random.Generator, fan: Fan) -> None:
    """Scan random scenes with difficult geometry, with and without a grid index."""
    count, owned = int(random.integers(0, 60)), int(random.integers(0, 9))
    walls = random.choice([random.integers(-8, 8, (count, 2, 2)) / 4.0, random.uniform(-9, 9, (count, 2, 2))])
    walls[: count // 10] *= 10.0 ** random.integers(-300, 150)
    posts = np.abs(random.normal(0.0, 2.0, (int(random.integers(0, 5)), 3))) - [1.0, 1.0, 0.0]
    robots = int(random.integers(1, 6))
    owners = np.sort(random.integers(0, robots, owned))
    cuts = [cut_of(walls, posts), cut_of(walls, posts)]
    cuts[1].tiles = Tiles(cuts[1].segments)
    planes = [ScanPlane(cut, random.uniform(0.0, 0.5, (owned, 3)), owners) for cut in cuts]
    scene = Scene(planes, random.integers(0, 2, robots).tolist(), random.normal(0.0, 0.1, (robots, 3)))
    scene.footprints[:] = random.choice(PLACES, (robots, 3))
    scene.footprints[0] = random.uniform(-4.0, 4.0, 3)
    for max_range in (0.0, 3.5, 1e300, math.inf):
        order, spec = random.permutation(robots), random.choice(sorted(PROFILES))
        ranges = np.zeros((robots, fan.samples))
        fan.casting(scene, order.tolist(), max_range, ranges)()
        assert ((ranges >= 0.0) & (ranges <= max_range) | np.isinf(ranges)).all()
        lidar = Lidar(replace(PROFILES[spec].spec, samples=max(2, fan.samples)))
        if fan.samples > 1:
            lidar.measuring(order.tolist(), Episode(1, int(random.integers(2**40))), ranges)()


SPEEDS = [0.0, 0.1, -1.0, 1e-300, 1e4, -1e9, 1e150, 1e308]
LIMITS = [Limits(1e308, 1e308, 1e308, 1e308, 0.0), Limits(0.2, 2.0, 1.0, 3.0, 0.5)]


def fleet_of(count: int, random: np.random.Generator) -> Fleet:
    """Burgers with different limits and radii."""
    limits = [LIMITS[int(random.integers(2))] for _ in range(count)]
    return Fleet([model_named("burger")] * count, limits, random.uniform(0.0, 0.3, count).tolist())


def forest(count: int, random: np.random.Generator) -> World:
    """A world of boxes, of which many are indexed by a grid, and of posts, of which one moves."""
    shapes = [Box(tuple(random.uniform(0.01, 0.5, 3) + [0.0, 0.0, 0.5])) for _ in range(count)]
    shapes += [Cylinder(float(radius), 1.0) for radius in random.uniform(0.01, 0.5, 4)]
    motions = [None] * (len(shapes) - 1) + [Motion(Pose2D(), waypoints=((3.0, 4.0, 0.0), (0.1, -9.0, 9.0)))]
    places = [Pose3D.from_xyz_rpy((*random.uniform(-4.0, 4.0, 2), 0.2), (0.0, 0.0, 1.0)) for _ in shapes]
    parts = zip(places, shapes, motions)
    return World("w", tuple(Obstacle(f"o{i}", *part) for i, part in enumerate(parts)), Pose2D(), (), "")


def drives(random: np.random.Generator, engine: KinematicEngine) -> None:
    """Drive a fleet at possible and impossible speeds, from possible and impossible places; integrate its odometry."""
    fleet = engine.fleet
    engine.reset([Pose2D(*random.uniform(-4.0, 4.0, 3)) for _ in fleet.models])
    if random.integers(3) == 0:
        engine.place(int(random.integers(len(fleet))), Pose2D(*random.choice(PLACES, 3)))
    errors = OdometryParams("encoders", 0.1, *random.choice([0.0, 1e-3, 1.0], 2).tolist())
    odometers = Odometers(errors, fleet)
    for step in range(0, 60, 10):
        for robot in range(len(fleet)):
            fleet.commands[robot] = random.choice(SPEEDS if step % 20 else SPEEDS[:3], 2)
            fleet.commanded_at[robot] = step / 30
        engine.advance(step, 10)
        engine.move_obstacles(step / 3.0)
        random.standard_normal(out=odometers.noise)
        odometers.update()
        assert all(engine.touching(robot) in (False, True) for robot in range(len(fleet)))


def messages(random: np.random.Generator) -> None:
    """Fill and send messages of all kinds."""
    near, far = socket.socketpair()
    topic: Any = SimpleNamespace(links=(SubscriberLink(SimpleNamespace(), near),), impl=None)
    rows = random.choice(PLACES, (4, 10))
    made = [
        packed_scan(PROFILES["lds02"].spec.with_samples(10), "scan", rows[0], counter()),
        packed_odometry("odom", "base", NO_VARIANCES, rows[1, :3], rows[1, 3:5]),
        packed_joint_state(rows[2, :2], rows[2, 2:4]),
        packed_imu("imu", ImuParams(), True, rows[3]),
        packed_transforms([("a", "b", rows[1, :3]), ("b", "c", rows[2, :3])]),
    ]
    batch = Batch([(topic, message) for message in made], [(topic, packed_clock())])
    for stamp_ns in random.integers(0, 2**60, 5).tolist():
        batch.send(stamp_ns)
        far.recv(10**6)
    near.close()
    far.close()


def main() -> None:
    """Argument: the folder of the libraries."""
    folder = sys.argv[1]
    compiled.find = lambda name, folders=None: os.path.join(folder, compiled.file_name(name))
    random = np.random.default_rng(0)
    fans = [Fan(*fan) for fan in FANS]
    for _ in range(25):
        for fan in fans:
            scans(random, fan)
        messages(random)
    for count in (0, 5, 400):
        for robots in (1, 2, 6):
            engine = KinematicEngine(forest(count, random), fleet_of(robots, random), 30)
            for _ in range(10):
                drives(random, engine)
    print("sound")


if __name__ == "__main__":
    main()
