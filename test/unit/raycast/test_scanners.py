"""What the scanners of all robots see."""

import math

import numpy as np
import pytest
from support import model_named

from aro_robocop_goto_as.geometry import Pose2D, Pose3D
from aro_robocop_goto_as.raycast.beams import Fan
from aro_robocop_goto_as.raycast.scanners import Scanners, circles_at
from aro_robocop_goto_as.world.model import Box, Obstacle, World


def test_each_scanner_sees_world_and_robots_at_its_own_height() -> None:
    models = [model_named(name) for name in ("burger", "waffle", "burger")]
    low_box = Obstacle("box", Pose3D((2.0, 0.0, 0.07)), Box((1.0, 1.0, 0.14)))
    at = [Pose2D(0.0, 0.0), Pose2D(0.0, 2.0, -math.pi / 2), Pose2D(0.0, -2.0)]
    burgers_lidar, waffles_lidar = (model.scan_height for model in models[:2])
    assert waffles_lidar < 0.14 < burgers_lidar
    fan = Fan(0.0, math.pi / 180.0, 360)
    world = World("w", (low_box,), Pose2D(), (), "")
    scans = fan.scan(Scanners(models, world, np.array(at)).scene, [0, 1, 2], 10.0)
    assert np.isinf(scans[0, 0]), "the box is below a Burger's scanner"
    assert scans[1, 45] == pytest.approx(1.5 * math.sqrt(2.0), abs=0.2)
    assert np.isinf(scans[0, 90]), "a Waffle is below a Burger's scanner"
    (_, _, radius), (_, _, scanner_radius) = (
        *circles_at(models[0], waffles_lidar),
        *circles_at(models[0], burgers_lidar),
    )
    assert scans[1, 0] == pytest.approx(2.064 - math.sqrt(radius**2 - 0.032**2))
    assert scans[0, 270] == pytest.approx(2.0 - scanner_radius)
