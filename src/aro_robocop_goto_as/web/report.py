"""The checks that failed in a recorded scenario, from the report beside its bag."""

import json
from dataclasses import dataclass
from pathlib import Path
from typing import Any, List


@dataclass(frozen=True)
class Failure:
    """A failed check: when [s, after the recording's beginning], and what was wrong."""

    check: str
    time: float
    text: str


def failures(bag: str) -> List[Failure]:
    """Those of the scenario that PART-SCENARIO.bag shows, in order of time; none without a report beside it."""
    path = Path(bag)
    try:
        checks = json.loads((path.parent / "report.json").read_text(encoding="utf-8"))["checks"]
        found = [_failure(check) for check in checks if check["failure"] and _place(check) == path.stem]
    except (OSError, ValueError, KeyError, TypeError):  # no report, or another file of this name
        return []
    return sorted(found, key=lambda failure: failure.time)


def _place(check: Any) -> str:
    return f"{check['part']}-{check['scenario']}"


def _failure(check: Any) -> Failure:
    failure = check["failure"]
    text = f"{failure['cause']} Expected {failure['expected']}, got {failure['seen']}."
    return Failure(str(check["name"]), float(failure["time"]), text)
