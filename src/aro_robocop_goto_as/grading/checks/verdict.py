"""The verdict of a check on one record, and the registry of all checks."""

from dataclasses import dataclass
from typing import Callable, Dict, Tuple, Union

from ..check_limits import Limits
from ..record import Record


@dataclass(frozen=True)
class Passed:
    """The contract was tested and kept."""


@dataclass(frozen=True)
class NotReached:
    """The scenario did not get far enough to test the contract."""

    why: str


@dataclass(frozen=True)
class Earlier:
    """The failure of another check, in which what was seen begins with `seen`."""

    check: str
    seen: str = ""


@dataclass(frozen=True)
class Failed:
    """The contract was broken: expected, seen, simulated time [s], likely cause.

    If one of the failures in `follows` occurred, this one follows from it, and its own cause does not apply.
    """

    expected: str
    seen: str
    time: float
    cause: str
    follows: Tuple[Earlier, ...] = ()


Verdict = Union[Passed, NotReached, Failed]
Check = Callable[[Record, Limits], Verdict]

CHECKS: Dict[str, Check] = {}
PLOTS: Dict[str, str] = {}


def check(plot: str) -> Callable[[Check], Check]:
    """Register a function as the check of its name; `plot` names the plot that illustrates it."""

    def register(function: Check) -> Check:
        CHECKS[function.__name__] = function
        PLOTS[function.__name__] = plot
        return function

    return register


def description(name: str) -> str:
    """The contract that a check tests: the first line of its docstring."""
    return (CHECKS[name].__doc__ or "").strip().splitlines()[0]


def sentences(*parts: str) -> str:
    """The parts that are not empty as sentences of one paragraph."""
    return " ".join(part if part.endswith(("?", ".")) else f"{part}." for part in parts if part)
