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


@pytest.mark.parametrize("name", SHIPPED)
def test_robot_starts_in_free_space_that_is_enclosed_and_has_the_documented_goals(name):
    world = load_world(find_world(name, str(WORLDS)))
    assert clearance(world, np.array([world.spawn.x, world.spawn.y])) >= (0.6 if name == "stage_4" else 0.3)
    free = free_cells(world)
    inside = flood(free, cell_of(world.spawn.x, world.spawn.y))
    if name != "empty":
        outside = flood(free, (0, 0))
        assert inside.any() and not (inside & outside).any(), "the outer wall has a gap"
        assert (inside | outside)[free].all(), "a place within the walls is unreachable"
    goals = re.findall(r"\(([^,()]+), ([^()]+)\)", Path(world.path).read_text(encoding="utf-8").split("Free goals:")[1])
    assert len(goals) >= 4
    assert [goal for goal in goals if not inside[cell_of(*map(float, goal))]] == []
