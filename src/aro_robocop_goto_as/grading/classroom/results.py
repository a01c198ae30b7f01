"""The folder of results: a folder per hand-in, put there whole or not at all; what is in it is not done again."""

import csv
import io
import json
import os
import shutil
import tempfile
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Dict, List, Mapping, Optional, Sequence, Tuple

from ..plan import PARTS, Plan
from .hand_ins import HandIn
from .worker import Done

STAMP = "hand_in.json"  # what the report beside it was made from
FORMULA = ("=", "+", "-", "@", "\t", "\r")  # a spreadsheet would calculate a text that begins with one of them
NOT_HANDED_IN = "not handed in"


@dataclass(frozen=True)
class Check:
    """A check's outcome for one hand-in."""

    name: str
    part: str
    outcome: str  # passed, failed, not reached
    points: float
    cause: str = ""


@dataclass(frozen=True)
class Result:
    """What is in one hand-in's folder."""

    name: str
    checks: Tuple[Check, ...]
    problems: Tuple[str, ...]
    seconds: float

    @property
    def points(self) -> float:
        """Reached in all, extra ones included."""
        return round(sum(check.points for check in self.checks), 6)

    def points_of(self, part: str) -> Optional[float]:
        """Reached with the server or the bridge; None when it was not handed in."""
        points = [check.points for check in self.checks if check.part == part]
        return round(sum(points), 6) if points else None

    def outcome(self, name: str) -> str:
        """passed, failed, not reached, or not handed in."""
        return next((check.outcome for check in self.checks if check.name == name), NOT_HANDED_IN)


class Results:
    """The folder, for hand-ins graded by one plan in one way."""

    def __init__(self, folder: Path, made_with: Mapping[str, Any]) -> None:
        self.folder = folder
        self._made_with = dict(made_with)
        folder.mkdir(parents=True, exist_ok=True)
        for left in folder.glob(".new-*"):  # of an interrupted run
            shutil.rmtree(left, ignore_errors=True)

    def has(self, hand_in: HandIn) -> bool:
        """Whether it was graded as it is now, by this plan."""
        try:
            stamp = json.loads((self.folder / hand_in.name / STAMP).read_text())
        except (OSError, ValueError):
            return False
        return bool(stamp.get("made_from") == self._from(hand_in.digest))

    def _from(self, digest: str) -> Dict[str, Any]:
        return {**self._made_with, "digest": digest}

    def keep(self, done: Done) -> None:
        """Put a report in its place; who looks meanwhile sees the old one or the new one."""
        new, place = Path(tempfile.mkdtemp(prefix=".new-", dir=self.folder)), self.folder / done.name
        new.chmod(0o755)
        for name, content in done.files.items():
            (new / name).write_bytes(content)
        stamp = {"made_from": self._from(done.digest), "seconds": round(done.seconds, 1), "worker": done.worker}
        (new / STAMP).write_text(json.dumps(stamp, indent=1))
        if place.exists():
            shutil.rmtree(place)
        os.rename(new, place)

    def read(self, name: str) -> Result:
        """What its report says."""
        folder = self.folder / name
        raw, stamp = json.loads((folder / "report.json").read_text()), json.loads((folder / STAMP).read_text())
        checks = [Check(it["name"], it["part"], it["outcome"], it["points"], (it["failure"] or {}).get("cause", ""))
                  for it in raw["checks"]]
        return Result(name, tuple(checks), tuple(raw["problems"]), stamp["seconds"])


def table(results: Sequence[Result], plan: Plan) -> str:
    """All results as CSV, a line each; points that can be reached are the same for all, handed in or not."""
    text = io.StringIO()
    rows = csv.writer(text, lineterminator="\n")
    most = round(sum(check.points for check in plan.checks if not check.extra), 6)
    rows.writerow(["name", "points", "of", *PARTS, "problem", *(check.name for check in plan.checks)])
    for it in results:
        parts = [NOT_HANDED_IN if it.points_of(part) is None else it.points_of(part) for part in PARTS]
        rows.writerow([_plain(it.name), it.points, most, *parts, _plain(" | ".join(it.problems)),
                       *(it.outcome(check.name) for check in plan.checks)])
    return text.getvalue()


def _plain(text: str) -> str:
    """A text that no spreadsheet takes for a formula."""
    return f"'{text}" if text.startswith(FORMULA) else text


def write_whole(path: Path, text: str) -> None:
    """A file that is there as a whole, or as it was."""
    new = path.with_name(f".{path.name}.new")
    new.write_text(text, encoding="utf-8", errors="replace")
    os.replace(new, path)


def in_order(results: Dict[str, Result]) -> List[Result]:
    """By name."""
    return [results[name] for name in sorted(results)]
