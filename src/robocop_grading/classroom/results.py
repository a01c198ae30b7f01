"""The results of a class: a folder per hand-in, so that an interrupted run can be continued."""

import json
import os
import shutil
import tempfile
from dataclasses import dataclass, fields
from pathlib import Path
from typing import Any, Dict, List, Mapping, Optional

from aro_robocop_goto_as.own_path import expect_own

from ..checks import Failed
from ..grades import CheckOutcome, CheckResult, Grade
from ..plan import CheckPlan, Plan, total

HAND_IN_STAMP = "hand_in.json"  # says from which hand-in and plan the report beside it was made
MAX_TOLD = 300  # characters of a hand-in's problems, and of a cause, on the terminal and in the overview


@dataclass(frozen=True)
class StoredGrade(Grade):
    """The grade of one hand-in, as its report has it."""

    seconds: float = 0.0  # [s, wall] that its grading took

    @property
    def is_judged(self) -> bool:
        """Return whether any part of the hand-in was judged; otherwise its problems say why not."""
        return bool(self.checks)

    def points_of(self, part: str) -> Optional[float]:
        """Points of the server or the bridge, without extra points; None if that part was not handed in."""
        checks = [it for it in self.checks if it.part == part and it.outcome is not CheckOutcome.NOT_HANDED_IN]
        return total(check.points for check in checks if not check.extra) if checks else None

    def outcomes(self, plan: Plan) -> List[str]:
        """For each check of the plan: its outcome, or nothing if nothing was judged."""
        known = {check.name: check.outcome.value for check in self.checks}
        return [known.get(check.name, "") for check in plan.checks]


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
        return bool(stamp.get("made_from") == self._from(digest))

    def _from(self, digest: str) -> Dict[str, str]:
        return {"plan": self._outcomes, "grader": self._version, "digest": digest}

    def keep(self, name: str, digest: str, report: Path, seconds: float) -> None:
        """Store the report in a folder; a concurrent reader sees the old one or the new one, never a mixture.

        For a moment between two renames, a reader sees none.
        """
        final = self.folder / name
        expect_own(final, HAND_IN_STAMP)
        new = Path(tempfile.mkdtemp(prefix=".new-", dir=self.folder))
        new.chmod(0o755)
        shutil.copytree(report, new, dirs_exist_ok=True)
        stamp = {"made_from": self._from(digest), "seconds": round(seconds, 1)}
        (new / HAND_IN_STAMP).write_text(json.dumps(stamp, indent=1))
        old = new.with_name(f"{new.name}.old")
        if final.exists():
            os.rename(final, old)
        os.rename(new, final)
        shutil.rmtree(old, ignore_errors=True)

    def read(self, name: str) -> StoredGrade:
        """The result that is stored for a hand-in, with the plan's points."""
        folder = self.folder / name
        raw, stamp = json.loads((folder / "report.json").read_text()), json.loads((folder / HAND_IN_STAMP).read_text())
        checks = [_check(it, self._checks[it["name"]]) for it in raw["checks"]]
        problems, notes = (tuple(raw.get(key, ())) for key in ("problems", "notes"))
        return StoredGrade(name, tuple(checks), problems, notes, seconds=stamp["seconds"])


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
