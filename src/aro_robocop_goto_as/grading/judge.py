"""Applies the checks of a plan to records: for each one an outcome, points and a reason."""

import enum
import re
from dataclasses import dataclass, replace
from typing import Dict, List, Mapping, Optional, Tuple

from .checks import CHECKS, Failed, NotReached, Passed, description, sentences
from .plan import CheckPlan, Plan
from .record import Record

INCOMPLETE = "an incomplete one"
NUMBER = re.compile(r"-?\d+(\.\d+)?")


class Outcome(enum.Enum):
    """The outcome of a check."""

    PASSED = "passed"
    FAILED = "failed"
    NOT_REACHED = "not reached"


@dataclass(frozen=True)
class CheckResult:
    """One check's line in the report."""

    name: str
    part: str
    sentence: str  # the contract
    outcome: Outcome
    points: float
    points_available: float
    extra: bool
    scenario: str = ""  # where it failed, or the first one that was examined
    failure: Optional[Failed] = None
    why: str = ""  # reason for NOT_REACHED
    follows: str = ""  # name of the check whose failure is the reason for this one

    def explanation(self) -> str:
        """The outcome with its reason."""
        if self.failure is None:
            return f"{self.outcome.value}: {self.why}" if self.why else self.outcome.value
        return (
            f"failed: {sentences(self.failure.cause)} Expected {self.failure.expected}, got {self.failure.seen}, "
            f"at {self.failure.time:.1f} s of scenario {self.scenario}"
        )


@dataclass(frozen=True)
class Mistake:
    """A failure that does not follow from another one, the points it costs, and how many failures follow from it."""

    check: CheckResult
    points: float
    followers: int

    @property
    def sentence(self) -> str:
        """What the mistake is."""
        return "" if self.check.failure is None else sentences(self.check.failure.cause)


@dataclass(frozen=True)
class Grade:
    """The results of all checks of one submission, and the problems that kept parts of it from being run."""

    name: str
    checks: Tuple[CheckResult, ...]
    problems: Tuple[str, ...] = ()

    @property
    def points(self) -> float:
        """Points scored, extra ones included."""
        return round(sum(check.points for check in self.checks), 6)

    @property
    def points_available(self) -> float:
        """Points available, extra ones excluded."""
        return round(sum(check.points_available for check in self.checks if not check.extra), 6)

    @property
    def all_right(self) -> bool:
        """Whether every check that is not extra passed."""
        return all(check.outcome is Outcome.PASSED for check in self.checks if not check.extra)

    @property
    def mistakes(self) -> List[Mistake]:
        """The mistakes, the most expensive one first."""
        found = []
        for check in self.checks:
            if check.outcome is Outcome.FAILED and not check.follows:
                lost = [other.points_available for other in self.checks if other.follows == check.name]
                found.append(Mistake(check, round(check.points_available + sum(lost), 6), len(lost)))
        return sorted(found, key=lambda mistake: -mistake.points)

    def failed(self) -> List[str]:
        """Names of the failed checks."""
        return [check.name for check in self.checks if check.outcome is Outcome.FAILED]


Records = Mapping[str, Mapping[str, Record]]  # part -> scenario -> record


def printable(text: str) -> str:
    """One line without characters that control a terminal or are not allowed in XML."""
    return "".join(character if character.isprintable() else " " for character in text)


def printable_lines(text: str) -> str:
    """The same for a text that may have several lines."""
    return "\n".join(printable(line) for line in text.split("\n"))


def judge(name: str, plan: Plan, records: Records, problems: Mapping[str, str]) -> Grade:
    """Grade the parts that have records; `problems` (part -> text) explains records that are missing."""
    checks = [
        _judge(check, plan, records[check.part], problems.get(check.part, ""))
        for check in plan.checks
        if check.part in records
    ]
    checks = [result for part in records for result in _with_reasons([it for it in checks if it.part == part])]
    found = [f"{part}: {text}" for part, text in problems.items() if text]
    if any(check.outcome is not Outcome.PASSED for check in checks):
        found += [f"{part}: {text}" for part, by_name in records.items() for text in _unpublished(by_name)]
    return Grade(name, tuple(checks), tuple(found))


def _unpublished(records: Mapping[str, Record]) -> List[str]:
    """What to say of topics that the node waits for in vain; its action server's own have no client by then."""
    hint = "; the position comes from /odom, as on a real robot"
    return [
        f"it subscribes to {topic}, which nobody publishes{hint if 'ground_truth' in topic else ''}"
        for record in records.values()
        for topic in record.unpublished
        if topic.rpartition("/")[0] not in record.servers
    ]


def alike(text: str) -> str:
    """The text without its figures: causes that differ only in them are the same."""
    return NUMBER.sub("#", text)


def _with_reasons(results: List[CheckResult]) -> List[CheckResult]:
    """One part's results: a failure that follows from another one, or has an earlier one's cause, refers to that."""
    failures = {result.name: result.failure for result in results if result.failure is not None}
    reasons = {name: _reason(name, failures) for name in failures}
    first: Dict[str, str] = {}  # by cause
    for name, failure in failures.items():
        if reasons[name] == name:
            first.setdefault(alike(failure.cause), name)
    explained = []
    for result in results:
        if result.failure is not None:
            reason = first[alike(failures[reasons[result.name]].cause)]
            if reason != result.name:
                cause = f'This follows from another failed check: "{description(reason).rstrip(".")}"'
                if result.failure.seen == INCOMPLETE:
                    cause = result.failure.cause
                result = replace(result, failure=replace(result.failure, cause=cause), follows=reason)
        explained.append(result)
    return explained


def _reason(name: str, failures: Mapping[str, Failed]) -> str:
    """The check with whose failure it begins."""
    chain = [name]
    while True:
        for earlier in failures[chain[-1]].follows:
            failure = failures.get(earlier.check)
            if failure is not None and earlier.check not in chain and failure.seen.startswith(earlier.seen):
                chain.append(earlier.check)
                break
        else:
            return chain[-1]


def _judge(check: CheckPlan, plan: Plan, records: Mapping[str, Record], problem: str) -> CheckResult:
    """A check fails if it fails in one scenario, and passes if it passes in at least one."""
    passed, why, examined = False, "", ""
    for name in check.scenarios:
        if name not in records:
            if problem:
                failure = Failed("a complete scenario", INCOMPLETE, 0.0, problem)
                return _result(check, Outcome.FAILED, name, failure)
            why = why or "the server did not start"
            continue
        verdict = CHECKS[check.name](records[name], plan.limits)
        examined = examined or name
        if isinstance(verdict, Failed):
            return _result(check, Outcome.FAILED, name, verdict)
        passed = passed or isinstance(verdict, Passed)
        if isinstance(verdict, NotReached):
            why = why or verdict.why
    if passed:
        return _result(check, Outcome.PASSED, examined)
    return _result(check, Outcome.NOT_REACHED, examined, why=why)


def _result(
    check: CheckPlan, outcome: Outcome, scenario: str, failure: Optional[Failed] = None, why: str = ""
) -> CheckResult:
    points, contract = check.points if outcome is Outcome.PASSED else 0.0, description(check.name)
    return CheckResult(
        check.name, check.part, contract, outcome, points, check.points, check.extra, scenario, failure, why
    )
