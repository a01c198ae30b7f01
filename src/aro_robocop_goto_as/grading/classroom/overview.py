"""Renders the results of a class as index.html: a row for each hand-in and for each check."""

import collections
import re
from typing import Any, Dict, Iterator, List, Mapping, Sequence, Tuple

from ..html import render
from ..plan import PARTS, Plan
from .results import NOT_HANDED_IN, Result

REFRESH = 5  # [s] while grading is in progress
MOST_CAUSES = 3
NUMBER = re.compile(r"-?\d+(\.\d+)?")
SYMBOLS = {"passed": "●", "failed": "✕", "not reached": "○", NOT_HANDED_IN: "–"}


def page(title: str, results: Sequence[Result], plan: Plan, waiting: Mapping[str, str], running: bool) -> str:
    """The overview; `waiting` maps the names that have no result yet to the reason."""
    return render(
        "overview.html",
        title=title,
        results=results,
        plan=plan,
        parts=PARTS,
        waiting=waiting,
        running=running,
        refresh=REFRESH,
        symbols=SYMBOLS,
        checks=list(_checks(results, plan)),
    )


def _checks(results: Sequence[Result], plan: Plan) -> Iterator[Dict[str, Any]]:
    """For each check the number of each outcome and the most frequent causes of failures."""
    for check in plan.checks:
        outcomes = collections.Counter(result.outcome(check.name) for result in results)
        causes = [line.cause for result in results for line in result.checks if line.name == check.name and line.cause]
        tried = len(results) - outcomes[NOT_HANDED_IN]
        yield {"name": check.name, "outcomes": outcomes, "tried": tried, "causes": _most_frequent(causes)}


def _most_frequent(causes: Sequence[str]) -> List[Tuple[str, int]]:
    """Causes with their counts; causes that differ only in numbers are counted together."""
    alike: Dict[str, List[str]] = {}
    for cause in causes:
        alike.setdefault(NUMBER.sub("#", cause), []).append(cause)
    groups = sorted(alike.values(), key=len, reverse=True)
    return [(group[0], len(group)) for group in groups[:MOST_CAUSES]]
