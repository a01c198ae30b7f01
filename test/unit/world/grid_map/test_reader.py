"""Occupied cells of a map become walls that scans see and that stop robots."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from map_files import room, write_map

from aro_robocop_goto_as.geometry import Pose2D, Twist2D, compose, inverse
from aro_robocop_goto_as.raycast.beams import Fan
from aro_robocop_goto_as.raycast.cross_section import CrossSection
from aro_robocop_goto_as.robot.model import RobotSpec
from aro_robocop_goto_as.sim_params import SimParams
from aro_robocop_goto_as.simulation.factory import make_simulator
from aro_robocop_goto_as.world.load import load_world
from aro_robocop_goto_as.world.model import Walls

HEIGHT = 0.182  # [m] of the lidar
LAB = Fan(0.0, 6.28319 / 359, 360)


def test_unknown_cells_are_not_walls(tmp_path):
    pixels = np.full((40, 40), 205)
    pixels[5:35, 5:35] = 254
    world = load_world(write_map(tmp_path, pixels))
    assert (world.occupancy.cells == -1).sum() == 700
    assert len(CrossSection(world, HEIGHT).segments) == 0


def test_origin_with_yaw_rotates_the_walls(tmp_path):
    world = load_world(write_map(tmp_path, room(), origin=f"[1, 2, {math.pi / 2}]"))
    cut = CrossSection(world, HEIGHT).segments
    assert cut[..., 0].min() == pytest.approx(1.0 - 30 * 0.05) and cut[..., 0].max() == pytest.approx(1.0)
    assert cut[..., 1].min() == pytest.approx(2.0) and cut[..., 1].max() == pytest.approx(2.0 + 40 * 0.05)


@given(st.integers(0, 10**6))
def test_scan_hits_in_an_extruded_map_fall_on_occupied_cells(tmp_path_factory, seed):
    random = np.random.default_rng(seed)
    pixels = np.where(random.random((60, 80)) < 0.03, 0, np.where(random.random((60, 80)) < 0.1, 205, 254))
    pixels[20:40, 20:40] = 254
    directory = tmp_path_factory.getbasetemp()
    world = load_world(write_map(directory, pixels, origin="[-1.3, 0.4, 0.3]"))
    occupancy = world.occupancy
    pose = compose(occupancy.origin, Pose2D(1.5, 1.5))
    distances = LAB.cast(np.array([[pose.x, pose.y, 0.0]]), CrossSection(world, HEIGHT))[0]
    angles = (6.28319 / 359 * np.arange(360))[np.isfinite(distances)]
    distances = distances[np.isfinite(distances)]
    assert len(distances) > 100
    hits = np.array([pose.x, pose.y]) + distances[:, None] * np.stack([np.cos(angles), np.sin(angles)], axis=1)
    grid = inverse(occupancy.origin)
    turn = np.array([[math.cos(grid.yaw), -math.sin(grid.yaw)], [math.sin(grid.yaw), math.cos(grid.yaw)]])
    cells = (hits @ turn.T + [grid.x, grid.y]) / occupancy.resolution
    near = [np.floor(cells + shift) for shift in ((1e-6, 1e-6), (1e-6, -1e-6), (-1e-6, 1e-6), (-1e-6, -1e-6))]
    framed = np.pad(occupancy.cells, 1, constant_values=-1)
    on_wall = [framed[c[:, 1].astype(int) + 1, c[:, 0].astype(int) + 1] == 100 for c in near]
    assert np.any(on_wall, axis=0).all()


@pytest.mark.parametrize("drive", ["wheels", "kinematic"])
def test_robot_is_stopped_by_the_walls_of_a_map(tmp_path, burger, drive):
    world = load_world(write_map(tmp_path, room(60, 60), origin="[-1.5, -1.5, 0]"))
    sim = make_simulator(
        SimParams.of(drive=drive, cmd_vel_timeout=0.0), world, [RobotSpec("", burger, Pose2D(1.0, 0.5))]
    )
    sim.command(Twist2D(0.2))
    for _ in range(240 * 4):
        sim.step({})
    assert 1.2 < sim.world_from_footprint().x < 1.45 and sim.touching()
    sim.close()


# Big maps


def office(cells=4000, cells_a_room=100):
    """Rooms of 5 x 5 m with doors and some boxes, at 0.05 m a cell."""
    random = np.random.default_rng(1)
    pixels = np.full((cells, cells), 254, dtype=np.uint8)
    for k in range(0, cells, cells_a_room):
        pixels[k : k + 3] = pixels[:, k : k + 3] = 0
    for i in range(0, cells, cells_a_room):
        for j in range(0, cells, cells_a_room):
            door, other_door = random.integers(15, 60, 2)
            pixels[i + door : i + door + 18, j : j + 3] = pixels[i : i + 3, j + other_door : j + other_door + 18] = 254
            for _ in range(4):
                (a, b), (h, w) = random.integers(8, cells_a_room - 14, 2), random.integers(1, 9, 2)
                pixels[i + a : i + a + h, j + b : j + b + w] = 0
    pixels[[0, -1]] = pixels[:, [0, -1]] = 0
    return pixels


@pytest.fixture(scope="module")
def big(tmp_path_factory):
    directory = tmp_path_factory.mktemp("big")
    return load_world(write_map(directory, office(), origin="[-100, -100, 0]"))


def free_poses(world, count, seed=2):
    random, poses = np.random.default_rng(seed), []
    origin, cells = world.occupancy.origin, world.occupancy.cells
    while len(poses) < count:
        row, column = random.integers(4, 3996, 2)
        if (cells[row - 3 : row + 4, column - 3 : column + 4] == 0).all():
            poses.append([origin.x + column * 0.05, origin.y + row * 0.05, random.uniform(-3, 3)])
    return np.array(poses)


def test_map_of_4000_by_4000_cells_has_less_than_80000_wall_segments(big):
    (walls,) = [o.geometry for o in big.obstacles if isinstance(o.geometry, Walls)]
    assert big.occupancy.cells.shape == (4000, 4000)
    assert (big.occupancy.cells == 100).sum() > 900_000
    assert 20_000 < len(walls.segments) < 80_000


def test_scan_in_a_big_map_equals_a_scan_of_all_its_walls(big):
    cut = CrossSection(big, HEIGHT)
    poses = free_poses(big, 5)
    seen = LAB.cast(poses, cut, reach=10.0)
    endless = LAB.cast(poses[:1], cut)
    cut.tiles = None
    every = LAB.cast(poses, cut)
    np.testing.assert_array_equal(seen, np.where(every <= 10.0, every, np.inf))
    np.testing.assert_array_equal(endless, every[:1])
