"""For each failure of one part the check with which it began, by the table of what follows from what."""

from typing import Callable, Dict, List, Mapping, Sequence

from .checks.consequences import FOLLOWS
from .checks.verdict import Failed, Kind, without_figures
from .faults import Faults
from .record import Record

UNRECORDED = (Kind.NOT_REACHED, Kind.INCOMPLETE)  # a row for any kind does not apply to these


class Reasons:
    """Applies the table to the failures of one part, by check in the plan's order."""

    def __init__(self, failures: Mapping[str, Failed], records: Mapping[str, Record], faults: Faults) -> None:
        """`records`: by check, the record of the scenario where it failed."""
        self._failures, self._records, self._faults = failures, records, faults

    def of(self, name: str) -> List[str]:
        """The failed checks from which a check's failure, or that it is not reached, follows; in the table's order."""
        failure = self._failures.get(name)
        kind = failure.kind if failure else Kind.NOT_REACHED
        rows = [row for row in FOLLOWS if not row.later or name in row.later.split()]
        rows = [row for row in rows if row.kind is kind or (row.kind is None and kind not in UNRECORDED)]
        rows = [row for row in rows if row.earlier in self._failures and row.earlier != name]
        return [row.earlier for row in rows if row.when is None or self._holds(row.when, name, row.earlier)]

    def _holds(self, when: Callable[[Record, Failed, Failed], bool], name: str, earlier: str) -> bool:
        record = self._records.get(name, Record("", ""))
        both = self._failures[name], self._failures[earlier]
        return self._faults.tried(f"whether {name} follows from {earlier}", False, when, record, *both)

    def first(self, names: Sequence[str]) -> Dict[str, str]:
        """For each of the checks the one with which it began; what begins with the same cause is one mistake."""
        first = first_reasons({name: self.of(name) for name in names})
        same: Dict[str, str] = {}  # by cause
        causes = {name: without_figures(failure.cause) for name, failure in self._failures.items()}
        for name, cause in causes.items():
            if first[name] == name:
                same.setdefault(cause, name)
        return {name: same[causes[it]] if it in causes else it for name, it in first.items()}


def first_reasons(reasons: Mapping[str, Sequence[str]]) -> Dict[str, str]:
    """For each check the one with which it began, itself if it has no reasons; `reasons` has the plan's order.

    Checks that are reasons for each other begin with what one of them has as a reason beyond the circle, or else with
    the first one of them.
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
