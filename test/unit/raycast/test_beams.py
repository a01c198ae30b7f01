"""Distances along a fan of beams, compared with the definition of each beam."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from support import analytic_distances, world_named

from aro_robocop_goto_as.geometry import Pose2D, Pose3D
from aro_robocop_goto_as.raycast.beams import Fan
from aro_robocop_goto_as.raycast.cross_section import CrossSection
from aro_robocop_goto_as.world.model import Box, Cylinder, Obstacle, World

LAB = Fan(0.0, 6.28319 / 359, 360)
fans = st.sampled_from(
    [LAB, Fan(-math.pi, math.pi / 180, 361), Fan(-2.0, 0.013, 300), Fan(1.0, 0.05, 200), Fan(3.0, 1.0, 1)]
)
coordinates = st.floats(-3, 3)
boxes = st.builds(
    lambda x, y, yaw, a, b: Obstacle("box", Pose3D.from_xyz_rpy((x, y, 0.2), (0, 0, yaw)), Box((a, b, 0.5))),
    coordinates,
    coordinates,
    st.floats(-4, 4),
    st.floats(0.05, 2),
    st.floats(0.05, 2),
)
posts = st.builds(
    lambda x, y, r: Obstacle("post", Pose3D((x, y, 0.2)), Cylinder(r, 0.5)),
    coordinates,
    coordinates,
    st.floats(0.05, 1),
)


def _away_from(x: float, y: float, obstacle: Obstacle) -> bool:
    """Whether a point is outside any obstacle of these sizes."""
    return math.hypot(obstacle.pose.position[0] - x, obstacle.pose.position[1] - y) > 1.5


@given(fans, st.lists(st.one_of(boxes, posts), max_size=6), coordinates, coordinates, st.floats(-10, 10))
def test_every_beam_of_any_fan_ends_at_the_nearest_obstacle(
    fan: Fan, obstacles: "list[Obstacle]", x: float, y: float, yaw: float
) -> None:
    world = World("w", tuple(o for o in obstacles if _away_from(x, y, o)), Pose2D(), (), "")
    angles = yaw + fan.angle_min + fan.increment * np.arange(fan.samples)
    near, far = (analytic_distances(world, x, y, angles + turn, 1e3) for turn in (-1e-7, 1e-7))
    expected = analytic_distances(world, x, y, angles, 1e3)
    seen = fan.cast(np.array([[x, y, yaw]]), CrossSection(world, 0.182))[0]
    # A beam that just grazes an obstacle may hit or miss it; all others must match.
    with np.errstate(invalid="ignore"):
        grazing = ~((near == far) | (np.abs(near - far) < 1e-3))
    assert seen[~grazing] == pytest.approx(expected[~grazing], abs=1e-3)


def test_casting_many_scanners_at_once_equals_casting_each_one() -> None:
    walls = CrossSection(world_named("stage_4"), 0.182)
    poses = np.random.default_rng(3).uniform(-2.2, 2.2, (300, 3))
    together = LAB.cast(poses, walls)
    assert together.shape == (300, 360)
    for pose, seen in zip(poses, together):
        assert (LAB.cast(pose[None, :], walls)[0] == seen).all()


def test_no_beam_passes_through_the_walls_of_a_closed_room() -> None:
    walls = CrossSection(world_named("maze_1"), 0.182)
    poses = np.random.default_rng(5).uniform(-0.4, 5.4, (2000, 3))
    assert np.isfinite(LAB.cast(poses, walls)).all()


def test_scanner_inside_a_circle_sees_its_far_side() -> None:
    drum = CrossSection(World("w", (Obstacle("o", Pose3D((0.5, 0, 0)), Cylinder(2.0, 1.0)),), Pose2D(), (), ""), 0.182)
    assert Fan(0.0, math.pi, 2).cast(np.zeros((1, 3)), drum)[0] == pytest.approx([2.5, 1.5])
