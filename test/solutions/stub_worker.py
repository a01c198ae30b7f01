"""A stub of grading for the workers of a class; they import it by this name, which no test module has for them."""

import functools
import json

from graded import PLAN

from robocop_grading.classroom.worker import Done
from robocop_grading.plan import load


@functools.lru_cache(maxsize=None)
def graded_report(right):
    """The checks of a report that is all right or all wrong; the cause lacks a figure."""
    failure = {"cause": "The robot stopped @ m away"}
    return json.dumps(
        [
            {
                "name": check.name,
                "part": check.part,
                "outcome": "passed" if right else "failed",
                "points": check.points if right else 0.0,
                "failure": None if right else failure,
                "extra": check.extra,
            }
            for check in load(PLAN).checks
        ]
    )


def graded_at_once(task):
    """Stands for worker.work: every third hand-in fails each check, with a figure of its own."""
    number = int(task.hand_in.name[1:6])
    checks = graded_report(number % 3 != 0).replace("@", str(number / 1000))
    report = f'{{"name": "{task.hand_in.name}", "checks": {checks}, "problems": []}}'
    files = {"report.json": report.encode(), "report.html": b"<html>" * 5_000}
    return Done(task.hand_in.name, task.hand_in.digest, files, 0.0, "stub")
