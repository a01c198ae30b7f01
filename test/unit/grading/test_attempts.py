"""Which of two attempts counts, of a scenario that was repeated with a new node."""

from dataclasses import replace

import pytest
from grading_records import GOAL, PLAN, RIGHT, changed

from robocop_grading.attempts import counting
from robocop_grading.checks import CHECKS
from robocop_grading.plan import AGAIN

STUCK = changed(results=(), problem="the robot made no progress for 8 s, and the goal did not end")
SEVERAL = changed(goals=(GOAL, replace(GOAL, id="h")))  # the second goal gets no result


@pytest.mark.parametrize(
    "others, again, counts, told",
    [
        pytest.param(
            {"left": RIGHT}, RIGHT, False, "no mistake had come before", id="the first: it went wrong by itself"
        ),
        pytest.param({"left": STUCK}, RIGHT, True, "may have left something behind", id="the second, after a mistake"),
        pytest.param(
            {"newer_goal": SEVERAL}, RIGHT, True, "may have left", id="the second, if a later goal of a node fails"
        ),
        pytest.param({"beside": STUCK}, RIGHT, False, "no mistake", id="the first, if a mistake comes only later"),
        pytest.param({"left": RIGHT}, STUCK, True, "", id="the second, if it fails as well"),
    ],
)
def test_attempt_that_counts(others, again, counts, told):
    records = {**others, "right": replace(STUCK, name="right"), f"right{AGAIN}": replace(again, name=f"right{AGAIN}")}
    records.update({name: replace(record, name=name) for name, record in others.items()})
    chosen, counted, said = counting(PLAN, records)
    assert chosen["right"] == replace(again if counts else STUCK, name="right")
    assert counted == (["right"] if counts else [])
    assert told in "".join(said) and bool(said) == bool(told)


def test_exception_in_a_check_leaves_the_choice_to_the_other_checks(monkeypatch):
    check = CHECKS["reaches_goal"]
    monkeypatch.setitem(CHECKS, "reaches_goal", replace(check, judge=lambda record, limits: 1 / 0))
    records = {
        "left": RIGHT,
        "right": replace(STUCK, name="right"),
        f"right{AGAIN}": replace(RIGHT, name=f"right{AGAIN}"),
    }
    assert set(counting(PLAN, records)[0]) == {"left", "right"}


def test_repeated_scenarios_are_told_in_one_sentence():
    names = ("right", "behind")
    records = {name: replace(STUCK, name=name) for name in ("left", *names)}
    records.update({f"{name}{AGAIN}": replace(RIGHT, name=f"{name}{AGAIN}") for name in names})
    (told,) = counting(PLAN, records)[2]
    assert told.endswith("(an earlier mistake may have left something behind): right, behind")
