"""The world's cross-section at the lidar's height, compared with Bullet's ray tests and with values by hand."""

import math
from unittest import mock

import numpy as np
import pytest
import trimesh
from hypothesis import given
from hypothesis import strategies as st
from support import ORIGIN

from aro_robocop_goto_as.geometry import Pose2D, Pose3D
from aro_robocop_goto_as.physics import bullet_shapes
from aro_robocop_goto_as.physics.bullet import BulletEngine
from aro_robocop_goto_as.physics.bullet_obstacles import WORLD_GROUP
from aro_robocop_goto_as.physics.quiet_pybullet import pybullet
from aro_robocop_goto_as.raycast.beams import Beams
from aro_robocop_goto_as.raycast.cross_section import CrossSection
from aro_robocop_goto_as.robot.fleet import Fleet
from aro_robocop_goto_as.shapes import Box, Cylinder, Mesh, Plane, Sphere
from aro_robocop_goto_as.world.model import Obstacle, World

HEIGHT = 0.182
ANGLES = np.linspace(-math.pi, math.pi, 721)
DIRECTIONS = np.stack([np.cos(ANGLES), np.sin(ANGLES)], axis=1)
BEAMS = Beams(-math.pi, 2.0 * math.pi / 720, 721)


def _world(geometry, pose):
    return World("one", (Obstacle("one/link/shape", pose, geometry),), Pose2D(), (), "")


def _cast(world, origin=ORIGIN):
    return BEAMS.cast(np.array([[origin.x, origin.y, origin.yaw]]), CrossSection(world, HEIGHT))[0]


def _beam(angle):
    return int(np.argmin(np.abs(ANGLES - angle)))


def _bullet_distances(world, origin, far):
    engine = BulletEngine(world, Fleet([], [], []), 240, 20, 1.0)
    engine.reset([])
    start = (origin.x, origin.y, HEIGHT)
    turned = DIRECTIONS @ np.array(
        [[math.cos(origin.yaw), math.sin(origin.yaw)], [-math.sin(origin.yaw), math.cos(origin.yaw)]]
    )
    ends = np.column_stack([origin.x + far * turned[:, 0], origin.y + far * turned[:, 1], np.full(len(turned), HEIGHT)])
    hits = pybullet.rayTestBatch(
        [start] * len(ends), ends.tolist(), collisionFilterMask=WORLD_GROUP, physicsClientId=engine.client
    )
    engine.close()
    fractions = np.array([hit[2] for hit in hits])  # 1.0: no hit
    return np.where(fractions < 1.0, fractions * far, np.inf)


sizes = st.floats(0.1, 1.0)
geometries = st.one_of(
    st.builds(Box, st.tuples(sizes, sizes, sizes)),
    st.builds(Cylinder, sizes, sizes),
    st.builds(Sphere, sizes),
    st.builds(lambda *size: Mesh(trimesh.creation.box(size).triangles, ""), sizes, sizes, sizes),
)
tilts = st.floats(-1.5, 1.5)


@given(geometries, st.tuples(tilts, tilts, tilts), st.floats(-0.3, 0.6), st.floats(-3, 3))
def test_scans_of_upright_and_tilted_shapes_match_bullets_rays(geometry, rpy, z, yaw):
    world = _world(geometry, Pose3D.from_xyz_rpy((2.5, 0.5, z), rpy))
    ours = _cast(world, Pose2D(0.1, -0.2, yaw))
    with mock.patch.object(bullet_shapes, "MAX_TRIANGLES", 5):  # of the 12 of a box
        bullets = _bullet_distances(world, Pose2D(0.1, -0.2, yaw), 20.0)
    both = np.isfinite(ours) & np.isfinite(bullets)
    # Bullet's rays are only accurate to millimetres at grazing incidence, which is every beam on a thin tilted plate.
    # So nearly all beams must agree, and hardly any may differ in whether they hit.
    assert (np.isfinite(ours) != np.isfinite(bullets)).sum() <= 6
    if both.sum() >= 20:
        assert np.quantile(np.abs(ours[both] - bullets[both]), 0.8) < 0.01


def test_obstacles_above_or_below_the_lidar_are_not_seen():
    for z in (0.05, 0.4):
        for geometry in (Box((0.2, 0.2, 0.2)), Cylinder(0.1, 0.2), Sphere(0.1)):
            assert np.isinf(_cast(_world(geometry, Pose3D((1.0, 0.0, z))))).all()


def test_vertical_plane_is_an_infinite_wall_and_horizontal_plane_is_not_seen():
    wall = _cast(_world(Plane((0.0, -1.0, 0.0)), Pose3D((5.0, 2.0, 0.0))))
    assert wall[_beam(math.pi / 2)] == pytest.approx(2.0)
    assert wall[_beam(math.pi / 6)] == pytest.approx(4.0)
    assert np.isinf(wall[_beam(-math.pi / 2)])
    assert np.isinf(_cast(_world(Plane((0.0, 0.0, 1.0)), Pose3D()))).all()
