"""A grade as GitHub shows it: a summary of a workflow's run, and the points for GitHub Classroom."""

from typing import Dict

from ..judge import CheckResult, Grade, Outcome, printable
from .html import render

MARKS = {"passed": "✅", "failed": "❌", "not reached": "➖"}


def as_summary(grade: Grade) -> str:
    """Markdown for GITHUB_STEP_SUMMARY, failures first.

    It is an HTML block without empty lines, so that texts of the submission are not read as Markdown.
    """
    return render("summary.html", grade=grade, marks=MARKS)


def as_classroom(grade: Grade) -> Dict[str, object]:
    """The result of one runner as GitHub's action classroom-resources/autograding-grading-reporter reads it."""
    return {
        "version": 1,
        "status": "pass" if grade.all_right else "fail",
        "max_score": grade.points_available,
        "tests": [_test(check) for check in grade.checks if check.points or not check.extra],
    }


def _test(check: CheckResult) -> Dict[str, object]:
    passed = check.outcome is Outcome.PASSED
    return {
        "name": check.sentence,
        "status": "pass" if passed else "fail",
        "score": check.points,
        "message": "" if passed else printable(check.words),
        "test_code": check.name,
        "filename": "",
        "line_no": 0,
        "duration": 0,
    }
