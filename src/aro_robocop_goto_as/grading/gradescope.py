"""A grade as Gradescope's autograders report it."""

from typing import Dict

from .judge import Grade, Outcome, printable_lines
from .plan import Plan


def as_gradescope(grade: Grade, plan: Plan) -> Dict[str, object]:
    """The content of results.json: gradescope-autograders.readthedocs.io, section "Autograder output"."""
    tests = [
        {
            "name": printable_lines(check.sentence) + (" (extra)" if check.extra else ""),
            "number": f"{check.part}.{check.name}",
            "score": check.points,
            "max_score": 0.0 if check.extra else check.points_available,
            "status": "passed" if check.outcome is Outcome.PASSED else "failed",
            "output": printable_lines(check.explanation()),
        }
        for check in grade.checks
    ]
    output = [*map(printable_lines, grade.problems), f"scenarios: seed {plan.seed}"]
    return {"score": grade.points, "output": "\n".join(output), "tests": tests}
