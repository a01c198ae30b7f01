"""Two and three mistakes at once, over recordings: each report names what its mistakes explain, and nothing else."""

import itertools
import math
import random
from dataclasses import replace

import pytest
from grading_records import RIGHT, graded

from robocop_grading import record as rec
from robocop_grading.grades import CheckOutcome

SCENARIOS = ("left", "far")
RAISED = rec.Line(5.0, "[ERROR] Exception in your execute callback: division by zero")


def told(change):
    """A mistake in each feedback message."""
    return lambda record: replace(record, feedback=tuple(map(change, record.feedback)))


def commanded(change):
    """A mistake in each command."""
    return lambda record: replace(record, commands=tuple(map(change, record.commands)))


def ended(**fields):
    """A mistake in the result."""

    def change(record):
        results = tuple(replace(it, **fields) for it in record.results)
        return replace(record, results=results, statuses=tuple(rec.Status(it.time, it.id, it.status) for it in results))

    return change


MISTAKES = {
    "drives first": commanded(lambda it: replace(it, v=0.16) if it.time < 1.0 else it),
    "turns away": commanded(lambda it: replace(it, w=-it.w)),
    "never turns": commanded(lambda it: replace(it, w=0.0)),
    "curves": commanded(lambda it: replace(it, w=0.5) if it.v else it),
    "backward": commanded(lambda it: replace(it, v=-it.v)),
    "never stops": lambda record: replace(record, samples=tuple(replace(it, v=0.2) for it in record.samples)),
    "never ends": lambda record: replace(record, results=(), statuses=(), problem="no progress"),
    "ends early": ended(time=5.0),
    "ends late": ended(time=12.5),
    "aborts": ended(status=rec.ABORTED, success=False),
    "no message": ended(message=""),
    "contradiction": ended(success=False),
    "two results": lambda record: replace(record, results=record.results * 2),
    "no feedback": lambda record: replace(record, feedback=()),
    "feedback slow": lambda record: replace(record, feedback=record.feedback[::5]),
    "position squared": told(lambda it: replace(it, position_error=it.position_error**2)),
    "position zero": told(lambda it: replace(it, position_error=0.0)),
    "angle's sign": told(lambda it: replace(it, angle_error=-it.angle_error)),
    "angle not finite": told(lambda it: replace(it, angle_error=math.nan)),
    "raises": lambda record: replace(record, lines=(*record.lines, RAISED)),
    "dies": lambda record: replace(record, node_ends=(rec.NodeEnd(9.0, 1),)),
}


OTHERS = [name for number, name in enumerate(MISTAKES) if number % 3]


def grade_of(names):
    record = RIGHT
    for name in names:
        record = MISTAKES[name](record)
    return graded(replace(RIGHT, name="start"), *(replace(record, name=scenario) for scenario in SCENARIOS))


@pytest.fixture(scope="module")
def alone():
    return {name: grade_of([name]) for name in MISTAKES}


def possible(names):
    """Return whether these mistakes do not exclude each other: a robot that drives on does not stand at the goal."""
    return not {"never stops", "ends late"} <= set(names)


def expect_explained(grade, alone):
    """The report of several mistakes, beside that of each of them alone."""
    assert not grade.tracebacks and grade.mistakes
    lost = {check.name for check in grade.checks if check.outcome is not CheckOutcome.PASSED}
    lost_alone = {check.name for it in alone for check in it.checks if check.outcome is not CheckOutcome.PASSED}
    assert lost <= lost_alone
    failed_alone = {name for it in alone for name in it.failed()}
    assert {mistake.check.name for mistake in grade.mistakes} <= failed_alone


# A third of them with each run, all with --all.
@pytest.mark.parametrize("first", [*list(MISTAKES)[::3], *(pytest.param(it, marks=pytest.mark.slow) for it in OTHERS)])
def test_report_of_two_mistakes_names_only_what_they_explain(first, alone):
    for names in filter(possible, itertools.combinations(MISTAKES, 2)):
        if names[0] == first:
            expect_explained(grade_of(names), [alone[name] for name in names])


@pytest.mark.slow
def test_report_of_three_mistakes_names_only_what_they_explain(alone):
    triples = list(filter(possible, itertools.combinations(MISTAKES, 3)))
    for names in random.Random(0).sample(triples, 200):
        expect_explained(grade_of(names), [alone[name] for name in names])
