"""The overview of a class: a row for each hand-in; for each check its outcomes and the most frequent causes."""

import collections
from types import MappingProxyType
from typing import Any, Counter, Dict, Iterator, List, Mapping, Sequence, Tuple

from ..checks.verdict import without_figures
from ..files.exports import Person
from ..grades import CheckOutcome, Grade
from ..plan import PARTS, Plan
from ..report.write import render
from .results import MAX_TOLD
from .summary import Summary

MAX_CAUSES = 3
SYMBOLS = {"passed": "●", "failed": "✕", "not reached": "○", "not handed in": "–"}


def page(
    title: str,
    results: Sequence[Grade],
    plan: Plan,
    figures: Summary,
    missing: Mapping[str, str] = MappingProxyType({}),
    people: Mapping[str, Person] = MappingProxyType({}),
) -> str:
    """The page; `missing` maps the names that have no result to the reason."""
    return render(
        "overview.html",
        title=title,
        results=results,
        plan=plan,
        parts=PARTS,
        figures=figures,
        missing=missing,
        full_names={name: person.full_name for name, person in people.items()},
        longest=MAX_TOLD,
        symbols=SYMBOLS,
        checks=list(_checks(results, plan)),
    )


def _checks(results: Sequence[Grade], plan: Plan) -> Iterator[Dict[str, Any]]:
    """For each check the number of each outcome and the most frequent causes, without those of failures that follow."""
    counts = [collections.Counter(column) for column in zip(*(result.outcomes(plan) for result in results))]
    causes: Dict[str, Counter[str]] = collections.defaultdict(collections.Counter)
    for result in results:
        for it in result.checks:
            if it.failure is not None and not it.follows:
                causes[it.name][it.failure.cause] += 1
    for check, outcomes in zip(plan.checks, counts or [collections.Counter()] * len(plan.checks)):
        tried = len(results) - outcomes[CheckOutcome.NOT_HANDED_IN.value] - outcomes[""]
        frequent = _most_frequent(causes[check.name])
        yield {"check": check, "outcomes": outcomes, "tried": tried, "causes": frequent}


def _most_frequent(causes: Mapping[str, int]) -> List[Tuple[str, int]]:
    """Causes with their counts; causes that differ only in numbers are counted together."""
    groups: Dict[str, Tuple[str, int]] = {}  # by what is the same: the first of them, and how many there are
    for cause, count in causes.items():
        first, before = groups.get(without_figures(cause), (cause, 0))
        groups[without_figures(cause)] = first, before + count
    return sorted(groups.values(), key=lambda group: -group[1])[:MAX_CAUSES]
