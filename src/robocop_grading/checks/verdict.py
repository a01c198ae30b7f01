"""The verdict of a check on one record, and the registry of all checks with what they depend on."""

from dataclasses import dataclass
from typing import Callable, Dict, Optional, Sequence, Tuple, Union

from ..record import Goal, Record
from .limits import Limits


@dataclass(frozen=True)
class Passed:
    """The contract was tested and kept."""


@dataclass(frozen=True)
class NotReached:
    """The scenario did not get far enough to test the contract."""

    why: str


@dataclass(frozen=True)
class Failed:
    """The contract was broken: expected, seen, simulated time [s], likely cause.

    `kind` names the way in which it was broken, and `goal` the goal, where other failures may follow from this one or
    this one from others.
    """

    expected: str
    seen: str
    time: float
    cause: str
    kind: str = ""
    goal: Optional[Goal] = None


Verdict = Union[Passed, NotReached, Failed]
Check = Callable[[Record, Limits], Verdict]
Retry = Tuple[str, Callable[[Failed, Record, Limits], Failed]]
When = Callable[[Record, Failed, Failed], bool]  # the failed check's record and failure, and the earlier failure


def always(_record: Record, _failure: Failed, _earlier: Failed) -> bool:
    """For a failure that follows from every failure of the other check."""
    return True


@dataclass(frozen=True)
class After:
    """A check that another one depends on.

    If it has failed, too, and `when` holds, the other one's failure follows from it.
    """

    check: str
    when: When = always


CHECKS: Dict[str, Check] = {}
PLOTS: Dict[str, str] = {}
AFTER: Dict[str, Tuple[After, ...]] = {}
NEEDS: Dict[str, Tuple[str, ...]] = {}
RETRIED: Dict[str, Retry] = {}


def check(
    plot: str, after: Sequence[After] = (), needs: Sequence[str] = (), retried: Optional[Retry] = None
) -> Callable[[Check], Check]:
    """Register a function as the check of its name; `plot` names the plot that illustrates it.

    Its failure follows from the first one in `after` that applies. If it is not reached, the first one in `needs` that
    has failed is the reason. `retried` names another scenario, and a function that finds the cause from what happened
    there instead.
    """

    def register(function: Check) -> Check:
        name = function.__name__
        CHECKS[name], PLOTS[name], AFTER[name] = function, plot, tuple(after)
        NEEDS[name] = tuple(needs)
        if retried is not None:
            RETRIED[name] = retried
        return function

    return register


def description(name: str) -> str:
    """The contract that a check tests: the first line of its docstring."""
    return (CHECKS[name].__doc__ or "").strip().splitlines()[0]
