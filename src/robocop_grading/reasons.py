"""For each failure of one part the check with which it began, by the table of what follows from what."""

from dataclasses import replace
from typing import Dict, List, Mapping, Sequence

from .checks.consequences import FOLLOWS
from .checks.verdict import Failed, Kind, without_figures
from .faults import Faults
from .grades import CheckOutcome, CheckResult
from .record import Record
from .texts import sentences

NOT_EXPLAINED = "The grader failed when it looked for the cause"
UNRECORDED = (Kind.NOT_REACHED, Kind.INCOMPLETE)  # a row for any kind does not apply to these


def with_reasons(results: List[CheckResult], records: Mapping[str, Record], faults: Faults) -> List[CheckResult]:
    """One part's results, each of which names the check with which it began; the same cause is one mistake."""
    failures = {it.name: it.failure for it in results if it.failure is not None}
    where = {it.name: records.get(it.scenario, Record("", "")) for it in results}
    open_ones = [it.name for it in results if it.outcome is not CheckOutcome.PASSED]
    first = first_reasons({name: reasons_of(name, failures, where, faults) for name in open_ones})
    causes = {name: without_figures(sentences(failure.cause)) for name, failure in failures.items()}
    same: Dict[str, str] = {}  # by cause
    for name, cause in causes.items():
        if first[name] == name and NOT_EXPLAINED not in cause:
            same.setdefault(cause, name)
    begins = {name: same.get(causes.get(it, ""), it) for name, it in first.items()}
    return [replace(it, follows="" if begins.get(it.name, it.name) == it.name else begins[it.name]) for it in results]


def reasons_of(name: str, failures: Mapping[str, Failed], where: Mapping[str, Record], faults: Faults) -> List[str]:
    """The failed checks from which a check's failure, or that it is not reached, follows; in the table's order.

    `where`: by check, the record of the scenario where it failed.
    """
    kind = failures[name].kind if name in failures else Kind.NOT_REACHED
    reasons = []
    for later, of_kind, earlier, when in FOLLOWS:
        if (later and name not in later.split()) or earlier not in failures or earlier == name:
            continue
        if of_kind is kind or (of_kind is None and kind not in UNRECORDED):
            what = f"whether {name} follows from {earlier}"
            if when is None or faults.tried(what, False, when, where[name], failures[name], failures[earlier]):
                reasons.append(earlier)
    return reasons


def first_reasons(reasons: Mapping[str, Sequence[str]]) -> Dict[str, str]:
    """For each check the one with which it began, itself if it has no reasons; `reasons` has the plan's order.

    In a circle of reasons, the first reason outside of the circle counts, or else the circle's first check.
    """
    reached = {name: {name} for name in reasons}
    for found in reached.values():
        left = list(found)
        while left:
            new = set(reasons[left.pop()]) - found
            found |= new
            left += new

    def first(name: str) -> str:
        circle = [it for it in reasons if it in reached[name] and name in reached[it]]
        beyond = next((reason for it in circle for reason in reasons[it] if reason not in circle), None)
        return circle[0] if beyond is None else first(beyond)

    return {name: first(name) for name in reasons}
