"""Two and three mistakes in one server, a sample that a seed draws: each report names what its mistakes explain."""

import itertools
import random

import pytest
from graded import graded
from mistakes import ALLOWED, MISTAKES, with_mistakes

from robocop_grading.grades import CheckOutcome

SEED = 1
SAMPLE = {1: 3, 2: 6, 3: 3}  # how many combinations of so many mistakes

pytestmark = [pytest.mark.slow, pytest.mark.timeout(900)]


def excluded(names):
    """Return whether one of these mistakes can't be made beside another one."""
    return any(MISTAKES[name].excludes in names for name in names)


def drawn():
    """The sample, besides what was graded wrongly once: combinations of mistakes, without those that exclude others."""
    numbers = random.Random(SEED)
    found = [("drives_first", "never_ends"), ("never_preempted", "turns_slowly")]
    for size, number in SAMPLE.items():
        possible = [it for it in itertools.combinations(MISTAKES, size) if not excluded(it)]
        found += numbers.sample(possible, number)
    return found


@pytest.mark.parametrize("names", drawn(), ids="+".join)
def test_report_names_what_its_mistakes_explain_and_nothing_else(names, tmp_path):
    grade = graded("+".join(names), with_mistakes(names), tmp_path)
    expected = {check for name in names if name not in ALLOWED for check in MISTAKES[name].lost.split()}
    if len(names) > 1:
        expected |= {check for name in names if name not in ALLOWED for check in MISTAKES[name].beside.split()}
    assert not grade.tracebacks
    assert {it.name for it in grade.checks if it.outcome is not CheckOutcome.PASSED} <= expected
    assert bool(grade.mistakes) == bool(expected)
    if len(names) == 1:
        assert {it.name for it in grade.checks if it.outcome is not CheckOutcome.PASSED} == expected
