"""Results of a class, for the tests of their table and their page."""

import json
from pathlib import Path

from support import ROOT

from robocop_grading.classroom.results import Check, Result
from robocop_grading.classroom.worker import Done
from robocop_grading.plan import load

PLAN = load(Path(ROOT, "config", "grading.yaml"))


def report(name, points, cause=""):
    """A worker's result with one check."""
    failure = {"cause": cause} if cause else None
    check = {
        "name": "cancel",
        "part": "server",
        "outcome": "failed" if cause else "passed",
        "points": points,
        "failure": failure,
        "extra": False,
    }
    raw = json.dumps({"name": name, "checks": [check], "problems": []}).encode()
    return Done(name, f"digest of {name}", {"report.json": raw, "report.html": b"<html>"}, 3.0, "here")


RESULTS = (
    Result(
        "=anna",
        (
            Check("cancel", "server", "failed", 0.0, "<cause> at 1.5"),
            Check("action_server", "server", "passed", 0.5),
            Check("goal_frame", "bridge", "passed", 1.0, extra=True),
        ),
        (),
        9.0,
    ),
    Result("ben", (Check("cancel", "server", "failed", 0.0, "<cause> at -3"),), ("=cmd",), 9.0),
    Result("carl", (), ("nothing to grade",), 9.0),
)
