"""The results of a class: a folder per hand-in, so that an interrupted run can be continued."""

import json
import os
import shutil
import tempfile
from dataclasses import fields
from pathlib import Path
from typing import Any, Dict, Mapping

from aro_robocop_goto_as.own_path import expect_own

from ..checks import Failed
from ..grades import CheckOutcome, CheckResult, Grade
from ..plan import CheckPlan, Plan

HAND_IN_STAMP = "hand_in.json"  # says from which hand-in and plan the report beside it was made
MAX_TOLD = 300  # characters of a hand-in's problems, and of a cause, on the terminal and in the overview


class Results:
    """The folder of results that were made with a plan, its seed and a version of the grader."""

    def __init__(self, folder: Path, plan: Plan, version: str = "") -> None:
        self.folder, self._version, self._outcomes = folder, version, plan.outcomes
        self._checks = {check.name: check for check in plan.checks}
        folder.mkdir(parents=True, exist_ok=True)
        for unfinished in folder.glob(".new-*"):  # left by an interrupted run
            shutil.rmtree(unfinished, ignore_errors=True)

    def has(self, name: str, digest: str) -> bool:
        """Return whether a hand-in was graded with its present content, plan (but for points) and grader."""
        try:
            stamp = json.loads((self.folder / name / HAND_IN_STAMP).read_text())
        except (OSError, ValueError):
            return False
        return bool(stamp == self._made_from(digest))

    def _made_from(self, digest: str) -> Dict[str, str]:
        return {"plan": self._outcomes, "grader": self._version, "digest": digest}

    def keep(self, name: str, digest: str, report: Path) -> None:
        """Store the report in a folder; a concurrent reader sees the old one or the new one, never a mixture.

        For a moment between two renames, a reader sees none.
        """
        final = self.folder / name
        expect_own(final, HAND_IN_STAMP)
        new = Path(tempfile.mkdtemp(prefix=".new-", dir=self.folder))
        new.chmod(0o755)
        shutil.copytree(report, new, dirs_exist_ok=True)
        (new / HAND_IN_STAMP).write_text(json.dumps(self._made_from(digest), indent=1))
        old = new.with_name(f"{new.name}.old")
        if final.exists():
            os.rename(final, old)
        os.rename(new, final)
        shutil.rmtree(old, ignore_errors=True)

    def read(self, name: str) -> Grade:
        """The result that is stored for a hand-in, with the plan's points."""
        raw = json.loads((self.folder / name / "report.json").read_text())
        checks = [_check(it, self._checks[it["name"]]) for it in raw["checks"]]
        problems, notes = (tuple(raw.get(key, ())) for key in ("problems", "notes"))
        return Grade(name, tuple(checks), problems, notes)


def _check(raw: Mapping[str, Any], planned: CheckPlan) -> CheckResult:
    """A check's result as report.json has it, but with the points of today's plan."""
    outcome = CheckOutcome(raw["outcome"])
    points = planned.points if outcome is CheckOutcome.PASSED else 0.0
    failed = raw["failure"] and Failed(*(raw["failure"][it] for it in ("expected", "seen", "time", "cause")))
    values: Dict[str, Any] = {**raw, "outcome": outcome, "failure": failed, "extra": planned.extra, "points": points}
    values["points_available"] = planned.points
    return CheckResult(**{it.name: values[it.name] for it in fields(CheckResult)})


def write_atomically(path: Path, text: str) -> None:
    """Replace a file in one step, so that no reader sees half of it."""
    new = path.with_name(f".{path.name}.new")
    new.write_text(text, encoding="utf-8", errors="replace")
    os.replace(new, path)
