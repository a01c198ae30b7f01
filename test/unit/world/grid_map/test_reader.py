"""Occupied cells of a map become walls that scans see and that stop robots."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from map_files import room, write_map

from aro_robocop_goto_as.geometry import Pose2D, Twist2D
from aro_robocop_goto_as.raycast.cross_section import CrossSection
from aro_robocop_goto_as.robot.model import RobotSpec
from aro_robocop_goto_as.simulation.factory import make_simulator
from aro_robocop_goto_as.simulation.params import SimParams
from aro_robocop_goto_as.world.grid_map.reader import edges_of_cells
from aro_robocop_goto_as.world.load import load_world

HEIGHT = 0.182  # [m] of the lidar


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


@pytest.mark.parametrize("drive", ["wheels", "kinematic"])
def test_robot_is_stopped_by_the_walls_of_a_map(tmp_path, burger, drive):
    world = load_world(write_map(tmp_path, room(60, 60), origin="[-1.5, -1.5, 0]"))
    sim = make_simulator(
        SimParams.of(drive=drive, cmd_vel_timeout=0.0), world, [RobotSpec("", burger, Pose2D(1.0, 0.5))]
    )
    sim.command(Twist2D(0.2))
    for _ in range(240 * 4):
        sim.advance({})
    assert 1.2 < sim.world_from_footprint().x < 1.45 and sim.touching()
    sim.close()


@given(st.integers(1, 7), st.integers(1, 7), st.data())
def test_outline_is_all_edges_of_occupied_regions_in_maximal_segments(rows, columns, data):
    flags = data.draw(st.lists(st.booleans(), min_size=rows * columns, max_size=rows * columns))
    occupied = np.array(flags).reshape(rows, columns)
    segments = [(tuple(start), tuple(end)) for start, end in edges_of_cells(occupied).tolist()]
    for axis in (0, 1):  # a ray along it from the centre of an occupied cell crosses an odd number of edges
        across = [(start, end) for start, end in segments if start[axis] == end[axis]]
        for row, column in np.ndindex(rows, columns):
            cell = (column + 0.5, row + 0.5)
            ahead = [s[axis] > cell[axis] and s[1 - axis] < cell[1 - axis] < e[1 - axis] for s, e in across]
            assert sum(ahead) % 2 == occupied[row, column]
        assert not {start for start, _ in across} & {end for _, end in across}, "two pieces of one wall"
