"""What a grade consists of: each check's result, the mistakes with what follows from them, points in words."""

import enum
from dataclasses import dataclass, replace
from typing import Dict, List, Optional, Sequence, Tuple

from .checks import CHECKS, Failed
from .checks.verdict import Kind
from .plan import Plan, total
from .texts import sentences


class CheckOutcome(enum.Enum):
    """The outcome of a check."""

    PASSED = "passed"
    FAILED = "failed"
    NOT_REACHED = "not reached"
    NOT_HANDED_IN = "not handed in"


@dataclass(frozen=True)
class CheckResult:
    """One check's line in the report."""

    name: str
    part: str
    sentence: str  # the contract
    outcome: CheckOutcome
    points: float
    points_available: float
    extra: bool
    scenario: str = ""  # where it failed, or the first one that was examined
    failure: Optional[Failed] = None
    why: str = ""  # reason for NOT_REACHED
    follows: str = ""  # name of the check whose failure is the reason for this one, failed or not reached

    def marked(self, text: str) -> str:
        """A text about the check, which says if the check is extra."""
        return f"{text} (extra)" if self.extra else text

    @property
    def words(self) -> str:
        """The outcome with its reason."""
        failure = self.failure
        if failure is None:
            return f"{self.outcome.value}: {self.why}" if self.why else self.outcome.value
        cause = failure.cause
        if self.follows and failure.kind is not Kind.INCOMPLETE:
            cause = f'This follows from another failed check: "{CHECKS[self.follows].contract}"'
        return f"failed: {sentences(cause)} {self.observed}"

    @property
    def observed(self) -> str:
        """What was expected and seen of a failed check, and when."""
        failure = self.failure
        if failure is None:
            return ""
        return f'Expected {failure.expected}, got {failure.seen}, at {failure.time:.1f} s of scenario "{self.scenario}"'


@dataclass(frozen=True)
class Mistake:
    """A failure that does not follow from another failure, with its cost and the checks that it fails or blocks."""

    check: CheckResult
    points: float
    extra: float
    followers: Tuple[CheckResult, ...]  # failed checks first

    @property
    def cost(self) -> str:
        """The points in words."""
        words = [f"{self.points:g} point{'' if self.points == 1 else 's'}"] if self.points or not self.extra else []
        return " and ".join([*words, *([f"{self.extra:g} extra"] if self.extra else [])])

    @property
    def consequences(self) -> str:
        """Its followers in words: their names, by outcome."""
        by_outcome: Dict[str, List[str]] = {}
        for check in self.followers:
            by_outcome.setdefault(check.outcome.value, []).append(check.marked(check.name))
        return "; ".join(f"{outcome} because of it: {', '.join(names)}" for outcome, names in by_outcome.items())

    @property
    def sentence(self) -> str:
        """The mistake in words."""
        return "" if self.check.failure is None else sentences(self.check.failure.cause)


@dataclass(frozen=True)
class Grade:
    """The results of all checks of one submission."""

    name: str
    checks: Tuple[CheckResult, ...]
    problems: Tuple[str, ...] = ()  # that kept parts of it from being run
    notes: Tuple[str, ...] = ()  # which cost no points
    files: Tuple[str, ...] = ()  # which ones were graded, in words
    tracebacks: Tuple[str, ...] = ()  # of exceptions in the grader

    @property
    def points(self) -> float:
        """Points scored, without extra ones."""
        return total(check.points for check in self.checks if not check.extra)

    @property
    def points_available(self) -> float:
        """Points available, without extra ones."""
        return total(check.points_available for check in self.checks if not check.extra)

    @property
    def extra(self) -> float:
        """Extra points scored."""
        return total(check.points for check in self.checks if check.extra)

    @property
    def extra_available(self) -> float:
        """Extra points available."""
        return total(check.points_available for check in self.checks if check.extra)

    @property
    def words(self) -> str:
        """The points scored, as in "7.5 of 8 points, 1 of 1 extra"; no words for a kind without points."""
        words = [f"{self.points:g} of {self.points_available:g} points"] if self.points_available else []
        words += [f"{self.extra:g} of {self.extra_available:g} extra"] if self.extra_available else []
        return ", ".join(words) or "nothing was judged"

    @property
    def is_judged(self) -> bool:
        """Return whether any part of the hand-in was judged; otherwise its problems say why not."""
        return bool(self.checks)

    def points_of(self, part: str) -> Optional[float]:
        """Points of the server or the bridge, without extra points; None if that part was not handed in."""
        checks = [it for it in self.checks if it.part == part and it.outcome is not CheckOutcome.NOT_HANDED_IN]
        return total(check.points for check in checks if not check.extra) if checks else None

    def outcomes(self, plan: Plan) -> List[str]:
        """For each check of the plan: its outcome, or nothing if nothing was judged."""
        known = {check.name: check.outcome.value for check in self.checks}
        return [known.get(check.name, "") for check in plan.checks]

    @property
    def all_right(self) -> bool:
        """Return whether every check that is not extra passed."""
        return all(check.outcome is CheckOutcome.PASSED for check in self.checks if not check.extra)

    @property
    def mistakes(self) -> List[Mistake]:
        """The mistakes, the most expensive one first."""
        found = []
        for check in self.checks:
            if check.outcome is CheckOutcome.FAILED and not check.follows:
                lost = [other for other in self.checks if other.follows == check.name]
                points = total(it.points_available for it in [check, *lost] if not it.extra)
                extra = total(it.points_available for it in [check, *lost] if it.extra)
                found.append(Mistake(check, points, extra, tuple(sorted(lost, key=lambda it: it.outcome.value))))
        return sorted(found, key=lambda mistake: (-mistake.points, -mistake.extra))

    @property
    def others(self) -> Dict[str, List[CheckResult]]:
        """The checks that neither failed nor follow from a mistake, by their outcomes in words: passed ones last."""
        known = {it.name for mistake in self.mistakes for it in (mistake.check, *mistake.followers)}
        others: Dict[str, List[CheckResult]] = {}
        for check in sorted(self.checks, key=lambda it: it.outcome is CheckOutcome.PASSED):
            if check.name not in known:
                others.setdefault(check.words, []).append(check)
        return others

    def failed(self) -> List[str]:
        """Names of the failed checks."""
        return [check.name for check in self.checks if check.outcome is CheckOutcome.FAILED]

    def failed_in(self, part: str, scenario: str) -> List[str]:
        """Names of the checks that failed in a scenario of a part."""
        return [it.name for it in self.checks if it.failure is not None and (it.part, it.scenario) == (part, scenario)]


def scored(checks: Sequence[CheckResult]) -> Tuple[float, float]:
    """Points scored and available, without extra ones unless all of these checks are extra."""
    counted = [check for check in checks if not check.extra] or checks
    return total(it.points for it in counted), total(it.points_available for it in counted)


def completed(grade: Grade, plan: Plan) -> Grade:
    """The grade with the checks of parts that were not handed in: the total is the same for everybody."""
    missing = [it for it in plan.checks if it.name not in {check.name for check in grade.checks}]
    outcome = CheckOutcome.NOT_HANDED_IN
    results = [
        CheckResult(it.name, it.part, it.contract, outcome, 0.0, it.points, it.extra, why=f"the {it.part}")
        for it in missing
    ]
    return replace(grade, checks=(*grade.checks, *results))
