"""An exception in the grader costs an explanation, never a grade, and its traceback is in the report's folder."""

import functools
import re
from dataclasses import replace
from pathlib import Path

import pytest
from grading_records import PLAN, RIGHT, graded

from robocop_grading import cli
from robocop_grading.checks import CHECKS
from robocop_grading.checks.consequences import FOLLOWS
from robocop_grading.judge import judge
from robocop_grading.record import Record
from robocop_grading.report.write import write


def test_exception_in_a_check_costs_no_points_of_other_scenarios_and_is_told(monkeypatch):
    check = CHECKS["reaches_goal"]
    expected = graded(RIGHT, Record("right", "server"))

    @functools.wraps(check.judge)
    def raises_in_right(record, limits):
        return {"left": check(record, limits)}[record.name]

    monkeypatch.setitem(CHECKS, "reaches_goal", replace(check, judge=raises_in_right))
    grade = graded(RIGHT, Record("right", "server"))
    assert {it.name: it.points for it in grade.checks} == {it.name: it.points for it in expected.checks}
    assert any("the grader failed at reaches_goal in scenario right: KeyError('right')" in it for it in grade.problems)
    assert "KeyError: 'right'" in grade.tracebacks[0] and "raises_in_right" in grade.tracebacks[0]


def test_exception_in_a_cause_or_in_the_table_leaves_every_outcome_as_it_was(monkeypatch):
    def raises(*_):
        raise ZeroDivisionError

    unfinished = Record("left", "server", goals=RIGHT.goals, samples=RIGHT.samples)
    records = {"server": {"left": unfinished}}
    before = judge("anna", PLAN, records, {})
    monkeypatch.setattr("robocop_grading.reasons.FOLLOWS", [row._replace(when=raises) for row in FOLLOWS])
    grade = judge("anna", PLAN, records, {})
    assert [(it.name, it.outcome, it.points) for it in grade.checks] == [
        (it.name, it.outcome, it.points) for it in before.checks
    ]
    assert "ZeroDivisionError" in grade.tracebacks[0] and any("the grader failed at" in it for it in grade.problems)


def test_traceback_is_written_beside_the_report(tmp_path):
    write(replace(graded(RIGHT), tracebacks=("Traceback: one", "Traceback: two")), PLAN, {}, tmp_path)
    assert (tmp_path / "traceback.txt").read_text() == "Traceback: one\nTraceback: two"


def test_grade_that_ends_with_an_exception_names_the_file_with_its_traceback(tmp_path, monkeypatch, capsys):
    monkeypatch.setattr("sys.argv", ["grade", "anna.py", "--report", str(tmp_path)])
    monkeypatch.setattr(cli, "load", lambda *_: {}["missing"])
    with pytest.raises(SystemExit, match=str(cli.NO_GRADE)):
        cli.main()
    shown = capsys.readouterr().err
    assert "could not be graded: KeyError('missing')" in shown
    (file,) = re.findall("its traceback is in (.*)", shown)
    assert "KeyError: 'missing'" in Path(file).read_text()
