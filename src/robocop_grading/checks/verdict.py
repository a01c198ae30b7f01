"""The verdict of a check on one record, and the table of all checks with what they depend on."""

from dataclasses import dataclass
from typing import Any, Callable, Dict, Mapping, Optional, Sequence, Union

from ..handout import Limits
from ..record import Goal, Record


@dataclass(frozen=True)
class Passed:
    """The contract was tested, and kept."""


PASSED = Passed()


@dataclass(frozen=True)
class NotReached:
    """The scenario did not get far enough to test the contract."""

    why: str


@dataclass(frozen=True)
class Failed:
    """The contract was broken: expected, seen, simulated time [s], likely cause.

    `kind` names the way in which the contract was broken, and `goal` the goal. Both are given if other failures may
    follow from this failure, or this failure from others.
    """

    expected: str
    seen: str
    time: float
    cause: str
    kind: str = ""
    goal: Optional[Goal] = None


Verdict = Union[Passed, NotReached, Failed]
Judge = Callable[[Record, Limits], Verdict]
Explain = Callable[[Mapping[str, Record], Sequence[str], Failed], Failed]  # all records, names of those to compare
When = Callable[[Record, Failed, Failed], bool]  # the failed check's record and failure, and the earlier failure


@dataclass(frozen=True)
class After:
    """An earlier check that a check depends on.

    If the earlier check has failed, too, the later failure follows from it if the later failure is of this `kind`
    (any kind if empty) and `when` holds.
    """

    check: str
    when: When = lambda _record, _failure, _earlier: True
    kind: str = ""

    def explains(self, record: Record, failure: Failed, earlier: Failed) -> bool:
        """Return whether a failure follows from the earlier failure of this check."""
        return self.kind in ("", failure.kind) and self.when(record, failure, earlier)


@dataclass(frozen=True)
class Check:
    """A function that judges one record, as the check of its name; `plot` names the plot that illustrates it.

    A failure of the check follows from the first check in `after` that applies. If the check is not reached, the
    first failed check in `needs` is the reason. `explain` names the causes of a failure that fit all scenarios which
    the check examines.
    """

    judge: Judge
    plot: str
    after: Sequence[After] = ()
    needs: Sequence[str] = ()
    explain: Optional[Explain] = None

    def __call__(self, record: Record, limits: Limits) -> Verdict:
        return self.judge(record, limits)

    @property
    def contract(self) -> str:
        """The contract that the check tests: the first line of its function's docstring."""
        return (self.judge.__doc__ or "").strip().splitlines()[0]


CHECKS: Dict[str, Check] = {}


def check(plot: str, **options: Any) -> Callable[[Judge], Judge]:
    """Have a function judge records as a Check with these options."""

    def register(judge: Judge) -> Judge:
        CHECKS[judge.__name__] = Check(judge, plot, **options)
        return judge

    return register
