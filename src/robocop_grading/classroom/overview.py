"""Renders the results of a class as index.html: a row for each hand-in and for each check."""

import collections
from typing import Any, Counter, Dict, Iterator, List, Mapping, Sequence, Tuple

from ..judge import alike
from ..plan import PARTS, Plan
from ..report.write import render
from .results import NOT_HANDED_IN, Result

REFRESH = 5.0  # [s] while grading is in progress ...
REFRESH_EACH = 0.01  # [s] ... and this for each hand-in: a browser needs longer for a long page
SHOWN = 200  # hand-ins until one asks for more
MOST_CAUSES = 3
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
        refresh=round(REFRESH + REFRESH_EACH * len(results)),
        shown=SHOWN,
        symbols=SYMBOLS,
        cells={outcome: f"<td class={outcome.split()[0]}>{symbol}" for outcome, symbol in SYMBOLS.items()},
        checks=list(_checks(results, plan)),
    )


def _checks(results: Sequence[Result], plan: Plan) -> Iterator[Dict[str, Any]]:
    """For each check the number of each outcome and the most frequent causes of failures."""
    counts = [collections.Counter(column) for column in zip(*(result.outcomes(plan) for result in results))]
    causes: Dict[str, Counter[str]] = collections.defaultdict(collections.Counter)
    for result in results:
        for line in result.checks:
            if line.cause:
                causes[line.name][line.cause] += 1
    for check, outcomes in zip(plan.checks, counts or [collections.Counter()] * len(plan.checks)):
        tried = len(results) - outcomes[NOT_HANDED_IN]
        yield {"name": check.name, "outcomes": outcomes, "tried": tried, "causes": _most_frequent(causes[check.name])}


def _most_frequent(causes: Mapping[str, int]) -> List[Tuple[str, int]]:
    """Causes with their counts; causes that differ only in numbers are counted together."""
    groups: Dict[str, Tuple[str, int]] = {}  # by what is alike: the first of them, and how many there are
    for cause, count in causes.items():
        first, before = groups.get(alike(cause), (cause, 0))
        groups[alike(cause)] = first, before + count
    return sorted(groups.values(), key=lambda group: -group[1])[:MOST_CAUSES]
