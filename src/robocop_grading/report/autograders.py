"""A grade as GitHub Classroom (classroom.json) and Gradescope (results.json) read it."""

from typing import Dict

from ..judge import CheckResult, Grade, Outcome, printable, printable_lines
from ..plan import Plan


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


def as_gradescope(grade: Grade, plan: Plan) -> Dict[str, object]:
    """The content of results.json: gradescope-autograders.readthedocs.io, section "Autograder output"."""
    tests = []
    for check in grade.checks:
        passed = check.outcome is Outcome.PASSED
        test: Dict[str, object] = {
            "name": printable_lines(check.sentence) + (" (extra)" if check.extra else ""),
            "number": f"{check.part}.{check.name}",
            "output": printable_lines(check.words),
        }
        if passed or not check.extra:  # an extra check that did not pass is shown without points, neither green nor red
            test["score"], test["max_score"] = check.points, 0.0 if check.extra else check.points_available
            test["status"] = "passed" if passed else "failed"
        tests.append(test)
    output = [*map(printable_lines, grade.problems), f"scenarios: seed {plan.seed}"]
    return {"score": grade.points, "output": "\n".join(output), "tests": tests}
