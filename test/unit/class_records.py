"""Results of a class, for the tests of their table and their page."""

import json
import tempfile
from pathlib import Path

from support import ROOT

from robocop_grading.classroom.results import Check, Result
from robocop_grading.plan_file import load

PLAN = load(Path(ROOT, "config", "grading.yaml"))


def keep(results, name, points, cause="", follows=""):
    """Store the report of a hand-in with one check, as a worker does."""
    failure = {"cause": cause} if cause else None
    check = {
        "name": "cancel",
        "part": "server",
        "outcome": "failed" if cause else "passed",
        "points": points,
        "failure": failure,
        "follows": follows,
        "extra": False,
    }
    keep_report(results, name, {"name": name, "checks": [check], "problems": []})


def keep_report(results, name, report):
    """Store a report."""
    with tempfile.TemporaryDirectory() as folder:
        Path(folder, "report.json").write_text(json.dumps(report))
        results.keep(name, f"digest of {name}", Path(folder), 3.0)


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
