"""The compiled caster: no beam passes a wall, and neither an index nor other robots change what it sees.

That the distances are right is compared with Bullet and with exact geometry, in test_cross_section.py and
test_simulator.py.
"""

import math
from typing import Tuple
from unittest import mock

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from support import world_named

from aro_robocop_goto_as.geometry import Pose2D
from aro_robocop_goto_as.raycast import tiles
from aro_robocop_goto_as.raycast.beams import BeamPlane, Beams, BeamScene
from aro_robocop_goto_as.raycast.cross_section import CrossSection
from aro_robocop_goto_as.raycast.tiles import Tiles
from aro_robocop_goto_as.world.model import World

Pose = Tuple[float, float, float]
LAB = Beams(0.0, 6.28319 / 359, 360)


def cut_of(segments, circles):
    """A cross-section with these segments (m, 2, 2) and circles (k, 3) [m] only."""
    cut = CrossSection(World("w", (), Pose2D(), (), ""), 0.1)
    cut.segments, cut.circles = np.array(segments, float).reshape(-1, 2, 2), np.array(circles, float).reshape(-1, 3)
    return cut


# On a lattice many things coincide: corners with beams and tile borders, scanners with walls, ends with ends.
lattice = st.integers(-12, 12).map(lambda n: n / 4.0)
coordinates = st.one_of(lattice, st.floats(-3.0, 3.0))
points = st.tuples(coordinates, coordinates)
segments = st.lists(st.tuples(points, points), max_size=8)
circles = st.lists(
    st.tuples(coordinates, coordinates, st.one_of(st.sampled_from([0.25, 1.0, 2.0]), st.floats(0.01, 4.0))), max_size=4
)
cuts = st.builds(cut_of, segments, circles)
yaws = st.one_of(st.integers(-8, 8).map(lambda n: n * math.pi / 4.0), st.floats(-10.0, 10.0))
poses = st.tuples(coordinates, coordinates, yaws)
spans = st.one_of(st.sampled_from([2.0 * math.pi, 6.28319, math.pi, 4.0 * math.pi]), st.floats(0.01, 15.0))
starts = st.one_of(st.sampled_from([0.0, -math.pi, math.pi, -math.pi / 2.0]), st.floats(-10.0, 10.0))
fans = st.builds(lambda start, span, n: Beams(start, span / max(n - 1, 1), n), starts, spans, st.integers(1, 90))


@given(fans, cuts, poses, st.floats(0.0, 5.0))
def test_maximum_range_removes_only_returns_beyond_it(beams, cut, pose, max_range):
    every = beams.cast(np.array([pose]), cut)
    seen = beams.cast(np.array([pose]), cut, reach=max_range)
    np.testing.assert_array_equal(seen, np.where(every <= max_range, every, np.inf))


@given(fans, poses, st.data(), st.floats(0.01, 9.0), st.floats(0.3, 2.8), st.floats(0.01, 3.0), st.booleans())
def test_beam_aimed_at_the_end_of_a_segment_hits_it(beams, pose, data, away, slant, length, left):
    beam = data.draw(st.integers(0, beams.samples - 1))
    angle = pose[2] + beams.angle_min + beam * beams.increment
    x, y = pose[0] + away * math.cos(angle), pose[1] + away * math.sin(angle)
    along = angle + (slant if left else -slant)
    segment = [[(x, y), (x + length * math.cos(along), y + length * math.sin(along))]]
    assert beams.cast(np.array([pose]), cut_of(np.array(segment), np.zeros((0, 3))))[0, beam] == pytest.approx(away)


@given(
    fans, segments, circles, poses, st.floats(0.5, 30.0), st.sampled_from([(1.0, 1 << 20), (8.0, 1 << 20), (8.0, 9)])
)
def test_scan_with_tiles_is_bit_identical_to_one_without(beams, walls, posts, pose, max_range, size):
    scale, max_tiles = size
    cut = cut_of(scale * np.array(walls, float), scale * np.array(posts, float))
    every = beams.cast(np.array([pose]), cut, reach=max_range)
    with mock.patch.object(tiles, "MAX_TILES", max_tiles):
        cut.tiles = Tiles(cut.segments)
    assert beams.cast(np.array([pose]), cut, reach=max_range).tobytes() == every.tobytes()


@given(coordinates, coordinates, st.integers(0, 7))
def test_beams_through_many_tiles_and_along_their_borders_see_what_all_segments_show(x, y, eighth):
    corners = [(i, j) for i in range(-12, 13, 4) for j in range(-12, 13, 4)]
    walls = [((i, j), (i + di, j + dj)) for i, j in corners for di, dj in ((0.5, 0.0), (0.0, 0.5))]
    cut, beams = cut_of(np.array(walls, float), np.zeros((0, 3))), Beams(0.0, math.pi / 36, 72)
    pose = np.array([[x, y, eighth * math.pi / 4]])
    every = beams.cast(pose, cut)
    cut.tiles = Tiles(cut.segments)
    assert beams.cast(pose, cut).tobytes() == every.tobytes()


@given(fans, st.lists(poses, min_size=1, max_size=6), st.lists(cuts, min_size=1, max_size=2), st.data())
def test_scanning_all_robots_at_once_is_bit_identical_to_one_at_a_time(beams, footprints, walls, data):
    robots = range(len(footprints))
    bodies = np.array(data.draw(st.lists(st.tuples(lattice, lattice, st.floats(0.05, 0.5)), max_size=9)))
    owners = np.array([i % len(footprints) for i in range(len(bodies))], np.int64)
    planes = [BeamPlane(cut, bodies.reshape(-1, 3), owners) for cut in walls]
    plane_of = [data.draw(st.integers(0, len(planes) - 1)) for _ in robots]
    scene = BeamScene(planes, plane_of, np.array([data.draw(poses) for _ in robots]), np.array(footprints))
    together = beams.scan(scene, robots, 5.0)
    order = data.draw(st.permutations(robots))
    assert beams.scan(scene, order, 5.0).tobytes() == together[order].tobytes()
    for robot in robots:
        assert beams.scan(scene, [robot], 5.0).tobytes() == together[robot].tobytes()


def test_no_beam_passes_through_the_walls_of_a_closed_room():
    walls = CrossSection(world_named("maze_1"), 0.182)
    assert np.isfinite(LAB.cast(np.random.default_rng(5).uniform(-0.4, 5.4, (2000, 3)), walls)).all()


def test_scanner_inside_a_circle_sees_its_far_side():
    drum = cut_of(np.zeros((0, 2, 2)), np.array([[0.5, 0.0, 2.0]]))
    assert Beams(0.0, math.pi, 2).cast(np.zeros((1, 3)), drum)[0] == pytest.approx([2.5, 1.5])


def test_scan_of_an_unknown_robot_or_from_a_pose_that_is_not_finite_is_refused():
    scene = BeamScene(
        [BeamPlane(cut_of(np.zeros((0, 2, 2)), np.zeros((0, 3))))], [0, 0], np.zeros((2, 3)), np.zeros((2, 3))
    )
    for robot in (-1, 2, 2**40):
        with pytest.raises(ValueError, match="^robots: "):
            LAB.scan(scene, [0, robot])
    scene.footprints[1, 2] = np.nan
    with pytest.raises(ValueError, match="^poses: expected finite numbers"):
        LAB.scan(scene, [0])
