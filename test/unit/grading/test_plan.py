"""The grading plan: points, limits, numbers drawn from ranges, and mistakes in the file."""

import dataclasses
import math
import re

import pytest
import yaml
from grading_records import LIMITS, PLAN, PLAN_FILE

from aro_robocop_goto_as.errors import ParameterError
from aro_robocop_goto_as.geometry import Pose2D
from aro_robocop_goto_as.shapes import Box, Cylinder
from robocop_grading.checks import CHECKS
from robocop_grading.errors import PlanError
from robocop_grading.packages import Packages
from robocop_grading.plan import PARTS
from robocop_grading.plan_file import load
from robocop_grading.scenarios import BRIDGE_SCENARIOS, MAX_SEED, SCRIPTS, START, Block


def test_plan_has_points_for_both_parts_and_a_function_for_each_check():
    points = {part: sum(it.points for it in PLAN.checks if it.part == part and not it.extra) for part in PARTS}
    assert all(points.values()) and PLAN.points == pytest.approx(sum(points.values()))
    assert {check.name for check in PLAN.checks} == set(CHECKS)


def test_each_check_examines_scenarios_of_its_part():
    known = {"server": {START, *SCRIPTS}, "bridge": {*BRIDGE_SCENARIOS}}
    assert all({*check.scenarios} <= known[check.part] for check in CHECKS.values())


def test_the_plan_documents_every_limit_with_its_default_and_sets_none():
    section = PLAN_FILE.read_text().partition("limits:\n")[2].partition("\n\n")[0].splitlines()
    lines = [re.fullmatch(r"  #(\w+): (\S+) +# \S.*", line) for line in section]
    assert all(lines) and yaml.safe_load(PLAN_FILE.read_text())["limits"] is None
    assert {line[1]: float(line[2]) for line in lines if line} == dataclasses.asdict(LIMITS)
    assert PLAN.limits == LIMITS


@pytest.mark.parametrize(
    "old, new, error",
    [
        ("  #feedback_low: 7.0", "  feedback_lou: 7.0", "did you mean 'feedback_low'"),
        ("limits:", "limits: [", "line"),
        ("checks:", "checks: 3\nall:", "checks: expected a mapping, got 3"),
        ("  #stall: 8.0", "  stall: .nan", "stall: expected a finite number"),
        ("{points: 0.5}", "{points: -1}", "points: expected at least 0"),
        ("  far_goal:", "  farr_goal:", "unknown: farr_goal"),
        ("packages:", "packages: {pypi: [--index-url=http://here]}", "expected the name of a package, got '--index"),
    ],
)
def test_a_mistake_in_the_plan_is_refused(tmp_path, old, new, error):
    text = PLAN_FILE.read_text()
    assert old in text
    (tmp_path / "plan.yaml").write_text(text.replace(old, new))
    with pytest.raises((PlanError, ParameterError), match=error):
        load(tmp_path / "plan.yaml")


def test_outline_of_a_block_is_that_of_its_shape_where_it_stands():
    box = Block(Pose2D(1.0, 2.0, math.pi / 2.0), Box((0.4, 0.2, 0.5))).outline
    circle = Block(Pose2D(1.0, 2.0), Cylinder(0.3, 0.5)).outline
    assert box == (0.9, 2.2, 0.9, 1.8, 1.1, 1.8, 1.1, 2.2)
    assert {round(math.hypot(x - 1.0, y - 2.0), 3) for x, y in zip(circle[::2], circle[1::2])} == {0.3}


def test_plan_names_packages_of_the_lab(tmp_path):
    lists = "packages: {debian: [python3-scipy, g++], pypi: ['numpy-stl==3.1', filterpy]}"
    (tmp_path / "plan.yaml").write_text(PLAN_FILE.read_text().replace("packages:", lists))
    assert load(tmp_path / "plan.yaml").packages == Packages(("python3-scipy", "g++"), ("numpy-stl==3.1", "filterpy"))
    assert PLAN.packages == Packages()


@pytest.mark.parametrize("seed", [1, 2, MAX_SEED])
def test_every_scenario_of_the_plan_differs_from_its_middle_and_is_repeatable(seed):
    chosen = load(PLAN_FILE, seed)
    assert chosen == load(PLAN_FILE, seed)
    drawn_by_name = {scenario.name: scenario for scenario in chosen.scenarios}
    for before in PLAN.scenarios:
        after = drawn_by_name[before.name]
        assert (before.steps, before.obstacles) != (after.steps, after.obstacles), before.name


@pytest.mark.parametrize("seed", [1, MAX_SEED])
def test_seed_draws_the_order_of_the_scenarios_after_the_first_one(seed):
    names, drawn_names = ([scenario.name for scenario in load(PLAN_FILE, it).scenarios] for it in (0, seed))
    assert sorted(names) == sorted(drawn_names) and names[0] == drawn_names[0] and names != drawn_names


@pytest.mark.parametrize("seed", [-1, MAX_SEED + 1])
def test_seed_out_of_bounds_is_refused(seed):
    with pytest.raises(PlanError, match=f"--seed {seed}: expected a number from 0 to {MAX_SEED}"):
        load(PLAN_FILE, seed)
