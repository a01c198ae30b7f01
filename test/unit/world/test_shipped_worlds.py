"""The shipped worlds suit the robot: free space around its start, closed walls, reachable goals."""

import re
from pathlib import Path

import numpy as np
import pytest
from rasters import cell_of, clearance, flood, free_cells
from support import ROOT

from aro_robocop_goto_as.world.load import find_world, load_world

WORLDS = Path(ROOT, "worlds")


SHIPPED = sorted(path.stem for path in WORLDS.glob("*.sdf"))


def shipped(name):
    return load_world(find_world(name, str(WORLDS)))


@pytest.mark.parametrize("name", SHIPPED)
def test_robot_spawns_with_free_space_around_it(name):
    world = shipped(name)
    required = 0.6 if name == "stage_4" else 0.3
    assert clearance(world, np.array([world.spawn.x, world.spawn.y])) >= required


@pytest.mark.parametrize("name", [name for name in SHIPPED if name != "empty"])
def test_free_space_within_the_walls_is_connected_and_enclosed(name):
    world = shipped(name)
    free = free_cells(world)
    inside = flood(free, cell_of(world.spawn.x, world.spawn.y))
    outside = flood(free, (0, 0))
    assert inside.any() and not (inside & outside).any(), "the outer wall has a gap"
    assert (inside | outside)[free].all(), "a place within the walls is unreachable"


@pytest.mark.parametrize("name", SHIPPED)
def test_documented_goals_of_a_world_are_reachable(name):
    world = shipped(name)
    goals = re.findall(r"\(([^,()]+), ([^()]+)\)", Path(world.path).read_text(encoding="utf-8").split("Free goals:")[1])
    inside = flood(free_cells(world), cell_of(world.spawn.x, world.spawn.y))
    assert len(goals) >= 4
    assert [goal for goal in goals if not inside[cell_of(*map(float, goal))]] == []
