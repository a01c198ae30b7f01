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

HEIGHT = 0.182  # [m] of the lidar
LAB = Fan(0.0, 6.28319 / 359, 360)


def test_unknown_cells_are_not_walls(tmp_path):
    pixels = np.full((40, 40), 205)
    pixels[5:35, 5:35] = 254
    world = load_world(write_map(tmp_path, pixels))
    assert (world.occupancy.cells == -1).sum() == 700
    assert len(CrossSection(world, HEIGHT).segments) == 0


def test_in_mode_raw_values_above_the_threshold_are_walls(tmp_path):
    pixels = np.full((4, 4), 65)
    pixels[0, 0] = 66
    cut = CrossSection(load_world(write_map(tmp_path, pixels, mode="raw")), HEIGHT).segments
    assert (len(cut), cut[..., 0].max(), cut[..., 1].min()) == (4, pytest.approx(0.05), pytest.approx(0.15))


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
