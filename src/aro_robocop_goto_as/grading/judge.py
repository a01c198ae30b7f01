"""Records and plan -> a grade: per check one outcome, points, and where it was seen."""

import enum
from dataclasses import dataclass
from typing import Dict, List, Mapping, Optional, Sequence, Tuple

from .checks import CHECKS, Failed, NotReached, Passed, sentence
from .plan import CheckPlan, Plan
from .record import Record


class Outcome(enum.Enum):
    """What became of a check."""

    PASSED = "passed"
    FAILED = "failed"
    NOT_REACHED = "not reached"


@dataclass(frozen=True)
class Line:
    """One check's line in the report."""

    name: str
    part: str
    sentence: str
    outcome: Outcome
    points: float
    of: float
    extra: bool
    scenario: str = ""  # where it failed, or the first one it looked at
    failure: Optional[Failed] = None
    why: str = ""  # it was not reached

    def words(self) -> str:
        """The outcome with its reason, for a person."""
        if self.failure is not None:
            it = self.failure
            end = "" if it.cause.endswith(("?", ".")) else "."
            return (f"failed: {it.cause}{end} Expected {it.expected}, seen {it.seen}, at {it.time:.1f} s of scenario "
                    f"{self.scenario}")
        return f"{self.outcome.value}: {self.why}" if self.why else self.outcome.value


@dataclass(frozen=True)
class Grade:
    """All checks of what was there to grade."""

    name: str
    lines: Tuple[Line, ...]
    problems: Tuple[str, ...] = ()

    @property
    def points(self) -> float:
        """Reached, extra ones included."""
        return round(sum(line.points for line in self.lines), 6)

    @property
    def of(self) -> float:
        """Points that could be reached, extra ones left out."""
        return round(sum(line.of for line in self.lines if not line.extra), 6)

    @property
    def all_right(self) -> bool:
        """Whether every check that is not extra passed."""
        return all(line.outcome is Outcome.PASSED for line in self.lines if not line.extra)

    def failed(self) -> List[str]:
        """Names of the checks that failed."""
        return [line.name for line in self.lines if line.outcome is Outcome.FAILED]


Records = Mapping[str, Mapping[str, Record]]  # part -> scenario -> record


def printable(text: str) -> str:
    """A text on one line, without characters that do something to a terminal or that XML does not allow."""
    return "".join(character if character.isprintable() else " " for character in text)


def judge(name: str, plan: Plan, records: Records, problems: Mapping[str, str]) -> Grade:
    """The grade for the parts that there are records of; `problems` (part -> words) says why some lack."""
    lines = [_line(check, plan, records[check.part], problems.get(check.part, ""))
             for check in plan.checks if check.part in records]
    return Grade(name, tuple(lines), tuple(f"{part}: {words}" for part, words in problems.items() if words))


def _line(check: CheckPlan, plan: Plan, records: Mapping[str, Record], problem: str) -> Line:
    """Failed where one scenario says so; passed where one says so and none failed."""
    function, passed, why, seen = CHECKS[check.name], False, "", ""
    for name in check.scenarios:
        if name not in records:
            if problem:
                return _made(check, Outcome.FAILED, name, Failed("the scenario is driven to its end", "it was not", 0.0,
                                                                 problem))
            why = why or "the server did not come up"
            continue
        verdict = function(records[name], plan.limits)
        seen = seen or name
        if isinstance(verdict, Failed):
            return _made(check, Outcome.FAILED, name, verdict)
        passed = passed or isinstance(verdict, Passed)
        why = verdict.why if isinstance(verdict, NotReached) and not why else why
    return _made(check, Outcome.PASSED if passed else Outcome.NOT_REACHED, seen, None, "" if passed else why)


def _made(check: CheckPlan, outcome: Outcome, scenario: str, failure: Optional[Failed], why: str = "") -> Line:
    points = check.points if outcome is Outcome.PASSED else 0.0
    return Line(check.name, check.part, sentence(check.name), outcome, points, check.points, check.extra, scenario,
                failure, why)


def not_reached(lines: Sequence[Line]) -> Dict[str, str]:
    """Name -> why, of the checks that were not reached."""
    return {line.name: line.why for line in lines if line.outcome is Outcome.NOT_REACHED}
