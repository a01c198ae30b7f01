"""bench.cases: words of the command line -> simulations that a simulator accepts."""

import math
from pathlib import Path

import numpy as np
import pytest
from bench import cases
from bench.cases import parse_cases

from aro_robocop_goto_as.param_loading import from_dict
from aro_robocop_goto_as.shapes import Plane
from aro_robocop_goto_as.sim_params import SimParams
from aro_robocop_goto_as.world.load import find_world, load_world

WORLDS = Path(__file__).resolve().parents[3] / "worlds"


@pytest.mark.parametrize(
    "words, names",
    [
        (["wheels:50"], ["wheels:50"]),
        (["kinematic"], ["kinematic:1", "kinematic:10", "kinematic:50"]),
        (["kinematic:3", "wheels:1", "wheels:1"], ["kinematic:3", "wheels:1"]),
    ],
)
def test_cases_are_given_by_drive_or_by_drive_and_number_of_robots(words, names):
    assert [case.name for case in parse_cases(words)] == names


@pytest.mark.parametrize("name", ["wheels:1", "wheels:50", "kinematic:200", "wheels:server"])
def test_parameters_of_a_case_are_valid_and_its_topics_those_of_its_robots(name):
    (case,) = parse_cases([name])
    params = from_dict(SimParams, case.params(0.0), case.name)
    robots = int(case.kind) if case.kind.isdigit() else 1
    assert params.rates.physics_rate == cases.PHYSICS_RATES[case.drive] and params.limits.cmd_vel_timeout == 0.0
    assert len(case.topics()) == 2 * robots and sum(case.topics().values()) == 35 * robots


def test_robots_circle_clear_of_obstacles_and_of_each_other():
    world = load_world(find_world("bench", str(WORLDS)))
    pillars = [item for item in world.obstacles if not isinstance(item.geometry, Plane) and "walls" not in item.name]
    assert sorted(tuple(item.pose.position[:2]) for item in pillars) == sorted(cases.OBSTACLES)
    places = np.array(cases.positions())
    assert len(places) >= 200
    turns = np.linspace(0.0, 2.0 * math.pi, 36)
    radius = cases.LINEAR / cases.ANGULAR
    circle = np.stack([radius * np.sin(turns), radius * (1.0 - np.cos(turns))], axis=1)
    path = places[:, None, :] + circle
    corner = math.hypot(0.25, 0.25)  # [m] from a block's centre
    assert np.linalg.norm(path[:, :, None] - np.array(cases.OBSTACLES), axis=-1).min() > corner + 0.105
    assert np.abs(path).max() < 4.85 - 0.105
    # All robots circle alike, so they keep their distances: the first 72, in usual cases, stay a metre apart.
    apart = np.linalg.norm(places[:, None] - places, axis=-1) + 9.0 * np.eye(len(places))
    assert apart.min() >= 0.5 and apart[:72, :72].min() >= 1.0
