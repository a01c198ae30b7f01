"""The shipped worlds suit the robot: free space around its start, closed walls, reachable goals."""

import re
from pathlib import Path

import numpy as np
import pytest
from rasters import cell_of, clearance, flood, free_cells
from support import ROOT

from aro_robocop_goto_as.geometry import Pose2D
from aro_robocop_goto_as.world.load import find_world, load_world
from aro_robocop_goto_as.world.model import Box, Cylinder, Plane

WORLDS = Path(ROOT, "worlds")


SHIPPED = {  # name: (boxes, cylinders, spawn), each with a ground plane besides
    "empty": (0, 0, Pose2D()),
    "stage_1": (4, 0, Pose2D()),
    "stage_2": (4, 4, Pose2D()),
    "stage_3": (4, 4, Pose2D()),
    "stage_4": (8, 2, Pose2D(-0.7, 0.0)),
    "world": (6, 9, Pose2D(-2.0, -0.5)),
    "maze_1": (18, 0, Pose2D()),
    "bench": (8, 5, Pose2D(1.0, 0.0)),
}


def shipped(name):
    return load_world(find_world(name, str(WORLDS)))


def test_every_shipped_world_is_tested():
    assert {path.stem for path in WORLDS.glob("*.sdf")} == set(SHIPPED)


@pytest.mark.parametrize("name", SHIPPED)
def test_shipped_world_has_the_expected_obstacles_and_spawn(name):
    world = shipped(name)
    kinds = [type(obstacle.geometry) for obstacle in world.obstacles]
    boxes, cylinders, spawn = SHIPPED[name]
    assert (kinds.count(Box), kinds.count(Cylinder), kinds.count(Plane)) == (boxes, cylinders, 1)
    assert len(kinds) == boxes + cylinders + 1
    assert (world.name, world.spawn, world.path) == (name, spawn, str(WORLDS / f"{name}.sdf"))
    assert len({obstacle.name for obstacle in world.obstacles}) == len(world.obstacles)


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
