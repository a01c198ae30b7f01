"""Random worlds are reproducible, and their documented goals are reachable."""

import re

import numpy as np
import pytest
from rasters import cell_of, clearance, flood, free_cells

from aro_robocop_goto_as.world.load import load_world
from aro_robocop_goto_as.world.random_maze import LANE, random_world


@pytest.mark.parametrize("seed", [1, 2, 3, 2**31 - 1])
def test_goals_of_a_random_world_are_reachable_by_lanes_of_the_documented_width_within_closed_walls(tmp_path, seed):
    (tmp_path / "random.sdf").write_text(random_world(seed), encoding="utf-8")
    world = load_world(str(tmp_path / "random.sdf"))
    goals = re.findall(r"\((\d), (\d)\)", random_world(seed).split("Free goals:")[1])
    free = free_cells(world)
    inside, outside = flood(free, cell_of(world.spawn.x, world.spawn.y)), flood(free, (0, 0))
    assert len(goals) >= 15
    assert [goal for goal in goals if not inside[cell_of(*map(float, goal))]] == []
    assert not (inside & outside).any()
    way = np.stack([np.linspace(-0.2, 0.2, 41), np.zeros(41)], axis=1)
    for centre in np.array(goals, dtype=float):
        for across in (way, way[:, ::-1]):
            assert (clearance(world, centre + across) >= LANE / 2.0 - 1e-6).all()


def test_random_world_depends_only_on_its_seed():
    assert random_world(7) == random_world(7)
    assert re.sub(r"random_\d+|seed \d+", "", random_world(7)) != re.sub(r"random_\d+|seed \d+", "", random_world(8))
