"""A grade as Gradescope's autograders report it."""

from typing import Dict

from ..judge import Grade, Outcome, printable_lines
from ..plan import Plan


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
