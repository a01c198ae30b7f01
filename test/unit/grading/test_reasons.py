"""What follows from what: the table has rows for known checks, and whatever fails begins with some check."""

import pytest
from grading_records import PLAN, RIGHT
from hypothesis import given
from hypothesis import strategies as st

from robocop_grading.checks import CHECKS, Failed
from robocop_grading.checks.consequences import FOLLOWS
from robocop_grading.checks.verdict import Kind
from robocop_grading.faults import Faults
from robocop_grading.reasons import first_reasons, reasons_of

SERVER = [check.name for check in PLAN.checks if check.part == "server"]


def begins_with_itself(reasons):
    """Return whether each check's first reason is one of those that it leads to, and has itself as its first one."""
    first = first_reasons(reasons)
    return all(first[first[name]] == first[name] for name in reasons)


@pytest.mark.parametrize(
    "reasons, first",
    [
        pytest.param({"a": ["b"], "b": ["c"], "c": []}, "ccc", id="the end of a chain"),
        pytest.param({"a": ["b", "c"], "b": [], "c": []}, "bbc", id="the first of two reasons"),
        pytest.param({"a": ["c"], "b": ["a"], "c": ["b"]}, "aaa", id="a circle's first check in the plan"),
        pytest.param({"a": ["b"], "b": ["a", "c"], "c": []}, "ccc", id="what a circle follows from"),
        pytest.param(
            {"a": ["b"], "b": ["c"], "c": ["b"]}, "bbb", id="the first check of a circle that a chain leads to"
        ),
    ],
)
def test_failure_begins_with(reasons, first):
    assert first_reasons(reasons) == dict(zip(reasons, first))


def test_rows_name_checks_and_no_row_has_a_check_follow_from_itself_only():
    for row in FOLLOWS:
        assert {*row.later.split(), row.earlier} <= {*CHECKS}, row
        assert row.later != row.earlier, row


@given(st.permutations(SERVER), st.data())
def test_whatever_subset_of_the_tables_rows_applies_each_failure_begins_with_some_check(order, data):
    failed = data.draw(st.sets(st.sampled_from(order), min_size=1))
    rows = data.draw(st.sets(st.sampled_from(range(len(FOLLOWS)))))
    reasons = {
        name: [
            FOLLOWS[number].earlier
            for number in sorted(rows)
            if FOLLOWS[number].earlier in failed - {name} and name in (FOLLOWS[number].later.split() or [name])
        ]
        for name in order
        if name in failed
    }
    assert begins_with_itself(reasons)


@given(st.dictionaries(st.sampled_from(SERVER), st.sampled_from(Kind), min_size=1))
def test_whatever_kinds_of_failures_there_are_each_begins_with_some_check(kinds):
    goal = RIGHT.goals[0]
    failures = {name: Failed("", "", 3.0, name, kinds[name], goal) for name in SERVER if name in kinds}
    where = dict.fromkeys(failures, RIGHT)
    assert begins_with_itself({name: reasons_of(name, failures, where, Faults()) for name in failures})
