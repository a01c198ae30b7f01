"""The grid index finds what a scan of all walls finds."""

import math

import numpy as np
import pytest

from aro_robocop_goto_as.geometry import Pose2D, Pose3D
from aro_robocop_goto_as.raycast.beams import Fan
from aro_robocop_goto_as.raycast.cross_section import CrossSection
from aro_robocop_goto_as.world.model import Obstacle, Walls, World

HEIGHT = 0.182  # [m] of the lidar
LAB = Fan(0.0, 6.28319 / 359, 360)


@pytest.mark.parametrize(
    "fan", [LAB, Fan(-2.0, 0.013, 300), Fan(1.0, 0.05, 200), Fan(3.0, 1.0, 1), Fan(-9.0, 0.1, 190)]
)
def test_grid_index_does_not_change_the_scan(fan):
    random = np.random.default_rng(4)
    starts = random.uniform(-12.0, 12.0, (3000, 1, 2))
    segments = np.concatenate([starts, starts + random.uniform(-0.5, 0.5, (3000, 1, 2))], axis=1)
    segments[:3] = [[[-1e4, 11.0], [1e4, 11.0]], [[-30.0, -11.5], [30.0, -11.0]], [[0.3, -20.0], [0.3, 20.0]]]
    segments[:, :, 0] += np.where(np.abs(segments[:, :, 0]) < 1.0, 5.0, 0.0)
    cut = CrossSection(World("w", (Obstacle("o", Pose3D(), Walls(segments, 1.0)),), Pose2D(), (), ""), HEIGHT)
    assert cut.tiles is not None
    poses = np.column_stack([random.uniform(-13, 13, (20, 2)), random.uniform(-10, 10, 20)])
    found = {reach: fan.cast(poses, cut, reach=reach) for reach in (0.7, 5.0, math.inf)}
    cut.tiles = None
    every = fan.cast(poses, cut)
    for reach, seen in found.items():
        np.testing.assert_array_equal(seen, np.where(every <= reach, every, np.inf))
