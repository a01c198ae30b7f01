"""The verdict of a check on one record, and the table of all checks."""

import enum
import re
from dataclasses import dataclass
from typing import Callable, Dict, Mapping, Optional, Sequence, Tuple, Union

from ..handout import Limits
from ..record import ABORTED, PREEMPTED, SUCCEEDED, Record, SentGoal
from ..scenarios import SCRIPTS, START

NUMBER = re.compile(r"-?\d+(\.\d+)?")


class Kind(enum.Enum):
    """The ways of breaking a contract that the table in consequences.py distinguishes."""

    NOT_REACHED = "not reached"  # no failure
    INCOMPLETE = "the scenario was not recorded"
    # A goal's end.
    NO_RESULT = "no result"
    SUCCEEDED = "SUCCEEDED instead of another state"
    ABORTED = "ABORTED instead of another state"
    PREEMPTED = "PREEMPTED instead of another state"
    OTHER_STATE = "another state"
    TOO_FAR = "success too far away from the goal"
    SUCCESS_LATE = "success too late"
    END_LATE = "an end too late after a request to end"
    TOO_EARLY = "an abort too far away from the obstacle"
    TOO_NEAR = "an abort too near to the obstacle"
    EXCEPTION = "an exception ended the goal"
    NOT_RESET = "an earlier goal has left something behind"
    NO_ANSWER = "the server no longer accepts goals"
    TWO_STATES = "two terminal states"
    NOT_ACCEPTED = "a terminal state of a goal that was not accepted"
    NO_MESSAGE = "a result without a message"
    # Motion.
    MOVES_FIRST = "motion before the errors and the distance are known"
    LONG_TURN = "a long turn"
    MOVING = "motion after the end"
    # Feedback.
    WRONG_ERROR = "an error is wrong"
    OLD_POSE = "an error is old"
    TOO_LITTLE = "too few messages"
    # The bridge.
    NO_GOAL = "no goal"
    OTHER_POSITION = "another position"
    NOT_CANCELLED = "not cancelled"
    NO_REPORT = "no report"


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
    """The contract was broken: expected, seen, simulated time [s], likely cause, in which way, and for which goal."""

    expected: str
    seen: str
    time: float
    cause: str
    kind: Optional[Kind] = None
    goal: Optional[SentGoal] = None


Verdict = Union[Passed, NotReached, Failed]
Judge = Callable[[Record, Limits], Verdict]
Explain = Callable[[Mapping[str, Record], Sequence[str], Failed], Failed]  # all records, names of those to compare


@dataclass(frozen=True)
class Check:
    """A function that judges one record, as the check of its name; `plot` names the plot that illustrates it.

    It examines these scenarios of this part, server or bridge; `explain` names the causes of a failure that fit all of
    them.
    """

    judge: Judge
    part: str
    scenarios: Tuple[str, ...]
    plot: str
    explain: Optional[Explain] = None

    def __call__(self, record: Record, limits: Limits) -> Verdict:
        return self.judge(record, limits)

    @property
    def contract(self) -> str:
        """The contract that the check tests: the first line of its function's docstring."""
        return (self.judge.__doc__ or "").strip().splitlines()[0]


CHECKS: Dict[str, Check] = {}
EVERY_SCENARIO = " ".join((START, *SCRIPTS))  # of a server


def check(part: str, scenarios: str, plot: str, explain: Optional[Explain] = None) -> Callable[[Judge], Judge]:
    """Have a function judge records of these scenarios as the check of its name."""

    def register(judge: Judge) -> Judge:
        CHECKS[judge.__name__] = Check(judge, part, tuple(scenarios.split()), plot, explain)
        return judge

    return register


def kind_of_wrong_state(status: int) -> Kind:
    """The kind of a failure whose goal ended in this state instead of another one."""
    return {SUCCEEDED: Kind.SUCCEEDED, ABORTED: Kind.ABORTED, PREEMPTED: Kind.PREEMPTED}.get(status, Kind.OTHER_STATE)


def without_figures(cause: str) -> str:
    """The cause without its figures: causes that differ only in figures are the same."""
    return NUMBER.sub("#", cause)
