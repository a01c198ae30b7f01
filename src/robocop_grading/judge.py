"""Applies the checks of a plan to records: each check gets an outcome, points and a reason."""

import enum
import re
from dataclasses import dataclass, replace
from typing import Dict, Iterable, List, Mapping, Optional, Sequence, Tuple

from .checks import CHECKS, Failed, NotReached, Passed, Verdict
from .checks.bridge import about_pending
from .checks.topic_types import wrong_type
from .plan import CheckPlan, Plan
from .record import Record
from .texts import sentences

INCOMPLETE = "an incomplete one"
FIRST = "action_server"  # the check without which no other one of a server is reached
ALIVE = "stays_alive"
NOT_STARTED = "the server did not start"
PROGRAMS = "in a grading, the programs that a node starts find no ROS master; rospy can do the same in the node itself"
TRUTH = "; the position comes from /odom, as on a real robot"
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
        place = f"at {failure.time:.1f} s of scenario {self.scenario}"
        return f"failed: {sentences(failure.cause)} Expected {failure.expected}, got {failure.seen}, {place}"


@dataclass(frozen=True)
class Mistake:
    """A failure that does not follow from another failure, its cost, and how many checks it fails and blocks."""

    check: CheckResult
    points: float
    extra: float
    followers: int
    blocked: int

    @property
    def cost(self) -> str:
        """The points in words."""
        words = [f"{self.points:g} point{'' if self.points == 1 else 's'}"] if self.points or not self.extra else []
        return " and ".join([*words, *([f"{self.extra:g} extra"] if self.extra else [])])

    @property
    def sentence(self) -> str:
        """The mistake in words."""
        return "" if self.check.failure is None else sentences(self.check.failure.cause)


@dataclass(frozen=True)
class Grade:
    """The results of all checks of one submission, and the problems that kept parts of it from being run."""

    name: str
    checks: Tuple[CheckResult, ...]
    problems: Tuple[str, ...] = ()
    files: Tuple[str, ...] = ()  # which ones were graded, in words

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
        """The points scored, as in "7.5 of 8 points, 1 of 1 extra"."""
        return points_in_words(self.points, self.points_available, self.extra, self.extra_available)

    @property
    def all_right(self) -> bool:
        """Return whether every check that is not extra passed."""
        return all(check.outcome is Outcome.PASSED for check in self.checks if not check.extra)

    @property
    def mistakes(self) -> List[Mistake]:
        """The mistakes, the most expensive one first."""
        found = []
        for check in self.checks:
            if check.outcome is Outcome.FAILED and not check.follows:
                lost = [other for other in self.checks if other.follows == check.name]
                points = total(it.points_available for it in [check, *lost] if not it.extra)
                extra = total(it.points_available for it in [check, *lost] if it.extra)
                failed = sum(other.outcome is Outcome.FAILED for other in lost)
                found.append(Mistake(check, points, extra, failed, len(lost) - failed))
        return sorted(found, key=lambda mistake: (-mistake.points, -mistake.extra))

    @property
    def failures_first(self) -> List[CheckResult]:
        """All results in this order: mistakes, failures that follow from them, checks not reached, passed checks."""
        order = [mistake.check for mistake in self.mistakes]
        order += [check for check in self.checks if check.outcome is Outcome.FAILED and check.follows]
        for outcome in (Outcome.NOT_REACHED, Outcome.PASSED):
            order += [check for check in self.checks if check.outcome is outcome]
        return order

    def failed(self) -> List[str]:
        """Names of the failed checks."""
        return [check.name for check in self.checks if check.outcome is Outcome.FAILED]


def total(points: Iterable[float]) -> float:
    """The sum of points without rounding errors."""
    return round(sum(points, 0.0), 6)


def points_in_words(points: float, available: float, extra: float, extra_available: float) -> str:
    """The points out of those available, in words, with extra points apart; no words for a kind without points."""
    words = [f"{points:g} of {available:g} points"] if available else []
    words += [f"{extra:g} of {extra_available:g} extra"] if extra_available else []
    return ", ".join(words) or "nothing was judged"


Records = Mapping[str, Mapping[str, Record]]  # part -> scenario -> record


def judge(name: str, plan: Plan, records: Records, problems: Mapping[str, str]) -> Grade:
    """Grade the parts that have records; `problems` (part -> text) explains records that are missing."""
    checks: List[CheckResult] = []
    for part, by_name in records.items():
        own = [_judge(it, plan, by_name, problems.get(part, "")) for it in plan.checks if it.part == part]
        checks += _with_reasons(own, by_name)
    found = [f"{part}: {problem}" for part, problem in problems.items() if problem]
    for part, by_name in records.items():
        said = [*_end_of(part, by_name, plan), *about_pending(by_name, plan.limits), *_programs(by_name)]
        if any(check.outcome is not Outcome.PASSED for check in checks):
            said += [*_unpublished(by_name), *_wrong_types(by_name, checks)]
        found += [f"{part}: {it}" for it in dict.fromkeys(said)]
    return Grade(name, tuple(checks), tuple(found))


def _programs(records: Mapping[str, Record]) -> List[str]:
    """Notes about programs of ROS that the node starts."""
    programs = sorted({program for record in records.values() for program in record.programs})
    return [f"it starts {', '.join(programs)}: {PROGRAMS}"] if programs else []


def _unpublished(records: Mapping[str, Record]) -> List[str]:
    """Notes about topics that the node waits for in vain.

    Topics of its own action server don't count: the server has no client when the record ends.
    """
    return [
        f"it subscribes to {topic}, which nobody publishes{TRUTH if 'ground_truth' in topic else ''}"
        for record in records.values()
        for topic in record.unpublished
        if topic.rpartition("/")[0] not in record.servers
    ]


def _end_of(part: str, records: Mapping[str, Record], plan: Plan) -> List[str]:
    """Why a server did not start, or ended, if no check of the plan examines this."""
    if part != "server" or {FIRST, ALIVE}.intersection(check.name for check in plan.checks):
        return []
    verdicts = [CHECKS[name](record, plan.limits) for record in records.values() for name in (FIRST, ALIVE)]
    return [sentences(verdict.cause) for verdict in verdicts if isinstance(verdict, Failed)][:1]


def _wrong_types(records: Mapping[str, Record], checks: Sequence[CheckResult]) -> List[str]:
    """Notes about topics that the node uses with a wrong type, unless a check names this as its cause."""
    said = "".join(check.words for check in checks)
    wrong = [wrong_type(record, topic) for record in records.values() for topic, *_ in record.other_types]
    return [it for it in wrong if it not in said]


def without_figures(text: str) -> str:
    """The text without its figures: causes that differ only in figures are the same."""
    return NUMBER.sub("#", text)


def _with_reasons(results: List[CheckResult], records: Mapping[str, Record]) -> List[CheckResult]:
    """One part's results; each that has no cause of its own gets the failure that it follows from, or is blocked by."""
    failed = {result.name: (result.failure, result.scenario) for result in results if result.failure is not None}
    causes = {name: without_figures(failure.cause) for name, (failure, _) in failed.items()}
    reasons = {name: _reason(name, failed, records) for name in failed}
    first: Dict[str, str] = {}  # by cause
    for name, reason in reasons.items():
        if reason == name:
            first.setdefault(causes[name], name)
    explained = []
    for result in results:
        if result.failure is not None:
            reason = first[causes[reasons[result.name]]]
            if reason != result.name:
                cause = f'This follows from another failed check: "{CHECKS[reason].contract}"'
                if result.failure.seen == INCOMPLETE:
                    cause = result.failure.cause
                result = replace(result, failure=replace(result.failure, cause=cause), follows=reason)
        elif result.outcome is Outcome.NOT_REACHED:
            needs = (FIRST,) if result.why == NOT_STARTED else CHECKS[result.name].needs
            blocking = next((name for name in needs if name in failed), "")
            result = replace(result, follows=blocking and first[causes[reasons[blocking]]])
        explained.append(result)
    return explained


def _reason(name: str, failed: Mapping[str, Tuple[Failed, str]], records: Mapping[str, Record]) -> str:
    """The check whose failure is the first reason."""
    chain = [name]
    while True:
        failure, scenario = failed[chain[-1]]
        for after in CHECKS[chain[-1]].after:
            possible = after.check in failed and after.check not in chain and scenario in records
            if possible and after.explains(records[scenario], failure, failed[after.check][0]):
                chain.append(after.check)
                break
        else:
            return chain[-1]


def _judge(check: CheckPlan, plan: Plan, records: Mapping[str, Record], problem: str) -> CheckResult:
    """A check fails if it fails in one scenario, and passes if it passes in at least one."""
    judged, contract = CHECKS[check.name], CHECKS[check.name].contract
    result = CheckResult(check.name, check.part, contract, Outcome.NOT_REACHED, 0.0, check.points, check.extra)
    for name in check.scenarios:
        verdict: Verdict = NotReached(NOT_STARTED)
        if name in records:
            verdict = judged(records[name], plan.limits)
            result = replace(result, scenario=result.scenario or name)
        elif problem:
            verdict = Failed("a complete scenario", INCOMPLETE, 0.0, problem)
        if isinstance(verdict, Failed):
            if judged.explain and name in records:
                verdict = judged.explain(records, [it for it in check.scenarios if it in records], verdict)
            return replace(result, outcome=Outcome.FAILED, points=0.0, scenario=name, failure=verdict, why="")
        if isinstance(verdict, Passed):
            result = replace(result, outcome=Outcome.PASSED, points=check.points, why="")
        elif result.outcome is Outcome.NOT_REACHED:
            result = replace(result, why=result.why or verdict.why)
    return result
