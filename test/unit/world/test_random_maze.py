"""Random worlds are reproducible, and their documented goals are reachable."""

import itertools
import re

import numpy as np
import pytest
from rasters import cell_of, clearance, flood, free_cells

from aro_robocop_goto_as.world.load import load_world
from aro_robocop_goto_as.world.random_maze import LANE, random_world


def made(directory, seed):
    path = directory / f"random_{seed}.sdf"
    path.write_text(random_world(seed), encoding="utf-8")
    return load_world(str(path))


@pytest.mark.parametrize("seed", [1, 2, 3, 2**31 - 1])
def test_goals_of_a_random_world_are_reachable_and_its_walls_are_closed(tmp_path, seed):
    world = made(tmp_path, seed)
    goals = re.findall(r"\((\d), (\d)\)", random_world(seed).split("Free goals:")[1])
    free = free_cells(world)
    inside, outside = flood(free, cell_of(world.spawn.x, world.spawn.y)), flood(free, (0, 0))
    assert len(goals) >= 15
    assert [goal for goal in goals if not inside[cell_of(*map(float, goal))]] == []
    assert not (inside & outside).any()


def test_random_world_depends_only_on_its_seed(tmp_path):
    assert random_world(7) == random_world(7)
    texts = [re.sub(r"random_\d+|seed \d+", "", random_world(seed)) for seed in range(1, 30)]
    assert all(a != b for a, b in itertools.combinations(texts, 2))


@pytest.mark.parametrize("seed", [1, 2, 3])
def test_lanes_through_every_cell_have_the_documented_width(tmp_path, seed):
    world = made(tmp_path, seed)
    goals = re.findall(r"\((\d), (\d)\)", random_world(seed).split("Free goals:")[1])
    ways = np.stack([np.linspace(-0.2, 0.2, 41), np.zeros(41)], axis=1)
    for centre in np.array(goals, dtype=float):
        for way in (ways, ways[:, ::-1]):
            assert (clearance(world, centre + way) >= LANE / 2.0 - 1e-6).all()
