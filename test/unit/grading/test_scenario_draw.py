"""Scenarios drawn from the plan's ranges: the same for one seed, within the ranges, others for other seeds."""

from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st
from support import ROOT

from aro_robocop_goto_as.errors import PlanError
from robocop_grading.plan import load
from robocop_grading.scenario_draw import LARGEST_SEED, MIDDLE, Draw

PLAN = Path(ROOT, "config", "grading.yaml")
SEEDS = st.integers(1, LARGEST_SEED)
NUMBERS = st.floats(-100.0, 100.0).map(lambda number: round(number, 3))


@given(SEEDS, st.tuples(NUMBERS, NUMBERS).map(sorted))
def test_drawn_number_is_within_its_range_and_repeatable(seed: int, limits: "list[float]") -> None:
    low, high = limits
    text = f"{low:.3f}..{high:.3f}"
    drawn = Draw(seed, "left").number(text, "here")
    assert low <= drawn <= high
    assert drawn == Draw(seed, "left").number(text, "here")


@given(st.one_of(NUMBERS, st.text().filter(lambda text: ".." not in text), st.none()))
def test_what_is_no_range_stays_as_it_is(value: object) -> None:
    assert Draw(3, "left").number(value, "here") == value


def test_seed_zero_takes_the_middle() -> None:
    assert Draw(MIDDLE, "left").number("-0.5..1.5", "here") == 0.5


def test_empty_range_is_refused_with_its_place() -> None:
    with pytest.raises(PlanError, match=r"left: goal: 2\.\.1: expected LOW\.\.HIGH"):
        Draw(1, "left").number("2..1", "left: goal")


@pytest.mark.parametrize("seed", [1, 2, LARGEST_SEED])
def test_every_scenario_of_the_plan_differs_from_its_middle_and_is_repeatable(seed: int) -> None:
    middle, drawn = load(PLAN), load(PLAN, seed)
    assert drawn == load(PLAN, seed)
    for before, after in zip(middle.scenarios, drawn.scenarios):
        assert (before.steps, before.obstacles) != (after.steps, after.obstacles), before.name


@pytest.mark.parametrize("seed", [-1, LARGEST_SEED + 1])
def test_seed_out_of_bounds_is_refused(seed: int) -> None:
    with pytest.raises(PlanError, match=f"--seed {seed}: expected a number from 0 to {LARGEST_SEED}"):
        load(PLAN, seed)
