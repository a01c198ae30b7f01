"""Applies the checks of a plan to records: for each one an outcome, points and a reason."""

import enum
from dataclasses import dataclass, replace
from typing import List, Mapping, Optional, Sequence, Tuple

from .checks import CHECKS, Failed, NotReached, Passed, description, sentences
from .plan import CheckPlan, Plan
from .record import Record

# Check -> by the state that its goal should have ended in, the check whose failure explains its own in that case.
FOLLOWS = {"odd_scans": {"ABORTED": "stops_at_obstacle", "SUCCEEDED": "reaches_goal"}}


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

    def explanation(self) -> str:
        """The outcome with its reason."""
        if self.failure is None:
            return f"{self.outcome.value}: {self.why}" if self.why else self.outcome.value
        return (
            f"failed: {sentences(self.failure.cause)} Expected {self.failure.expected}, got {self.failure.seen}, "
            f"at {self.failure.time:.1f} s of scenario {self.scenario}"
        )


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
    checks = [_following(check, checks, records) for check in checks]
    found = [f"{part}: {text}" for part, text in problems.items() if text]
    if any(check.outcome is not Outcome.PASSED for check in checks):
        found += [f"{part}: {text}" for part, by_name in records.items() for text in _unpublished(by_name)]
    return Grade(name, tuple(checks), tuple(found))


def _unpublished(records: Mapping[str, Record]) -> List[str]:
    """What to say of topics that the node waits for in vain."""
    hint = "; the position comes from /odom, as on a real robot"
    return [
        f"it subscribes to {topic}, which nobody publishes{hint if 'ground_truth' in topic else ''}"
        for record in records.values()
        for topic in record.unpublished
    ]


def _following(result: CheckResult, results: Sequence[CheckResult], records: Records) -> CheckResult:
    """The result of a check, which refers to an earlier check's failure if its own failure follows from that."""
    if result.failure is None or result.name not in FOLLOWS:
        return result
    record = records[result.part].get(result.scenario)
    earlier = {FOLLOWS[result.name].get(goal.ends, "") for goal in record.goals} if record is not None else set()
    for first in results:
        if first.name in earlier and first.failure is not None and not _another_ending(first.failure, result.failure):
            cause = f"This follows from a failure above ({first.sentence.rstrip('.')}): {first.failure.cause}"
            return replace(result, failure=replace(result.failure, cause=cause))
    return result


def _another_ending(first: Failed, failure: Failed) -> bool:
    """Whether a goal that had to succeed failed in another way than the first one, which then explains nothing."""
    return "SUCCEEDED" in failure.expected and failure.seen != first.seen


def _judge(check: CheckPlan, plan: Plan, records: Mapping[str, Record], problem: str) -> CheckResult:
    """A check fails if it fails in one scenario, and passes if it passes in at least one."""
    passed, why, examined = False, "", ""
    for name in check.scenarios:
        if name not in records:
            if problem:
                failure = Failed("a complete scenario", "an incomplete one", 0.0, problem)
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
