"""For each failure of one part the check with which it began, by the table of what follows from what."""

from itertools import takewhile
from typing import Dict, List, Mapping, Sequence

from .checks.consequences import FOLLOWS, Row
from .checks.verdict import Failed, Kind
from .faults import Faults
from .record import Record

UNRECORDED = (Kind.NOT_REACHED, Kind.INCOMPLETE)  # a row for any kind does not apply to these


class Reasons:
    """Applies the table to the failures of one part: (scenario, failure) by check, in the plan's order."""

    def __init__(self, failures: Mapping[str, Failed], records: Mapping[str, Record], faults: Faults) -> None:
        """`records`: by check, the record of the scenario where it failed."""
        self._failures, self._records, self._faults = failures, records, faults

    def of(self, name: str) -> List[str]:
        """The failed checks from which a check's failure, or that it is not reached, follows; in the table's order."""
        failure = self._failures.get(name)
        kind = failure.kind if failure else Kind.NOT_REACHED
        rows = [row for row in FOLLOWS if not row.later or name in row.later.split()]
        rows = [row for row in rows if row.kind is kind or (row.kind is None and kind not in UNRECORDED)]
        return [earlier for row in rows for earlier in self._earlier(row, name) if self._holds(row, name, earlier)]

    def _earlier(self, row: Row, name: str) -> List[str]:
        if not row.earlier:
            return list(takewhile(lambda it: it != name, self._failures))
        return [row.earlier] if row.earlier in self._failures and row.earlier != name else []

    def _holds(self, row: Row, name: str, earlier: str) -> bool:
        if row.when is None:
            return True
        what = f"whether {name} follows from {earlier}"
        both = self._failures[name], self._failures[earlier]
        return self._faults.tried(what, False, row.when, self._records.get(name, Record("", "")), *both)


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
