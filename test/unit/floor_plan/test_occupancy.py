"""The grid map of a world's cross-section: outlines occupied, reachable cells free, all others unknown."""

import math

import numpy as np
import pytest
from support import world_named

from aro_robocop_goto_as.floor_plan.occupancy import FREE, OCCUPIED, UNKNOWN, occupancy_of
from aro_robocop_goto_as.geometry import Pose2D, Pose3D
from aro_robocop_goto_as.raycast.beams import Beams
from aro_robocop_goto_as.raycast.cross_section import CrossSection
from aro_robocop_goto_as.shapes import Box
from aro_robocop_goto_as.world.model import Obstacle, World


def grid_of(cut, start, resolution):
    return occupancy_of(cut.segments, cut.circles, [start], resolution)


def value_at(occupancy, x, y):
    column = math.floor((x - occupancy.origin.x) / occupancy.resolution)
    row = math.floor((y - occupancy.origin.y) / occupancy.resolution)
    return occupancy.cells[row, column]


@pytest.mark.parametrize("name", ["stage_4", "world", "maze_1"])
def test_scan_hits_fall_on_occupied_cells_of_the_map(name):
    world = world_named(name)
    cut = CrossSection(world, 0.182)
    occupancy = grid_of(cut, world.spawn, 0.05)
    beams = Beams(0.0, math.pi / 180, 360)
    distances = beams.cast(np.array([[world.spawn.x, world.spawn.y, 0.0]]), cut)[0]
    for distance, angle in zip(distances, np.arange(360) * math.pi / 180):
        hit = world.spawn.x + distance * math.cos(angle), world.spawn.y + distance * math.sin(angle)
        nearby = [value_at(occupancy, hit[0] + dx, hit[1] + dy) for dx in (-1e-3, 1e-3) for dy in (-1e-3, 1e-3)]
        assert OCCUPIED in nearby
        half_way = (world.spawn.x + hit[0]) / 2.0, (world.spawn.y + hit[1]) / 2.0
        assert value_at(occupancy, *half_way) in (FREE, OCCUPIED)


def test_cells_that_any_of_several_robots_reaches_are_free_and_others_are_unknown():
    cut, inside = CrossSection(world_named("stage_4"), 0.182), Pose2D(-0.7, 0.0)
    for starts, outside in (([inside], UNKNOWN), ([inside, Pose2D(2.9, 2.9), Pose2D(1e6, 0.0)], FREE)):
        occupancy = occupancy_of(cut.segments, cut.circles, starts, 0.05)
        assert [value_at(occupancy, *place) for place in ((1.8, 1.8), (0.4, 0.5), (2.9, 2.9))] == [
            FREE,
            UNKNOWN,
            outside,
        ]
        assert occupancy.resolution == 0.05


def test_empty_world_is_a_small_free_map():
    occupancy = grid_of(CrossSection(world_named("empty"), 0.182), Pose2D(3.0, 4.0), 0.1)
    assert (occupancy.cells == FREE).all() and occupancy.cells.shape == (10, 10)
    assert (occupancy.origin.x, occupancy.origin.y) == (2.5, 3.5)


def test_huge_world_gets_coarser_cells():
    far = World("w", (Obstacle("b", Pose3D((900.0, 0.0, 0.1)), Box((1.0, 1.0, 1.0))),), Pose2D(), (), "")
    occupancy = grid_of(CrossSection(far, 0.182), Pose2D(), 0.05)
    assert max(occupancy.cells.shape) <= 4097 and occupancy.resolution == pytest.approx(901.5 / 4096, rel=1e-3)
