"""What a check says of one record."""

from dataclasses import dataclass
from typing import Callable, Dict, Tuple, Union

from ..plan import Limits
from ..record import Record


@dataclass(frozen=True)
class Passed:
    """The contract was put to the test, and kept."""


@dataclass(frozen=True)
class NotReached:
    """The record says nothing about the contract, since things did not come so far."""

    why: str


@dataclass(frozen=True)
class Failed:
    """The contract was broken: what was expected, what was seen, at which simulated second, the likely cause."""

    expected: str
    seen: str
    time: float
    cause: str


Verdict = Union[Passed, NotReached, Failed]
Check = Callable[[Record, Limits], Verdict]

CHECKS: Dict[str, Check] = {}
PLOTS: Dict[str, str] = {}


def check(plot: str) -> Callable[[Check], Check]:
    """Register a function as the check of its name; `plot` is the one that shows what it is about."""
    def register(function: Check) -> Check:
        CHECKS[function.__name__] = function
        PLOTS[function.__name__] = plot
        return function
    return register


def sentence(name: str) -> str:
    """What a check is about: the first line of its docstring."""
    return (CHECKS[name].__doc__ or "").strip().splitlines()[0]


def named(names: Tuple[str, ...]) -> str:
    """Names for a person."""
    return ", ".join(names) or "none"
