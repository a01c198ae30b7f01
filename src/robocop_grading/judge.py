"""Applies the checks of a plan to records: each check gets an outcome, points and a reason."""

import enum
from dataclasses import dataclass, replace
from typing import Iterable, List, Mapping, Optional, Sequence, Tuple

from .checks import CHECKS, Failed, NotReached, Passed, Verdict
from .checks.bridge import about_pending
from .checks.topic_use import wrong_type
from .checks.verdict import Kind
from .faults import Faults
from .plan import CheckPlan, Plan
from .reasons import Reasons, first_reasons
from .record import Record
from .texts import sentences

FIRST = "action_server"  # the check without which no other one of a server is reached
ALIVE = "stays_alive"
NOT_STARTED = "the server did not start"
NOT_JUDGED = "the grader failed when it judged this"
NOT_EXPLAINED = "The grader failed when it looked for the cause"
PROGRAMS = "in a grading, the programs that a node starts find no ROS master; rospy can do the same in the node itself"
TRUTH = "; the position comes from /odom, as on a real robot"


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
        cause = failure.cause
        if self.follows and failure.kind is not Kind.INCOMPLETE:
            cause = f'This follows from another failed check: "{CHECKS[self.follows].contract}"'
        return f"failed: {sentences(cause)} Expected {failure.expected}, got {failure.seen}, {place}"


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
    faults = Faults()
    for part, by_name in records.items():
        own = [_judge(it, plan, by_name, problems.get(part, ""), faults) for it in plan.checks if it.part == part]
        checks += faults.tried("what follows from what", own, _with_reasons, own, by_name, faults)
    found = [f"{part}: {problem}" for part, problem in problems.items() if problem]
    for part, by_name in records.items():
        nothing: List[str] = []
        said = faults.tried(f"notes about the {part}", nothing, _notes, part, by_name, plan, checks)
        found += [f"{part}: {it}" for it in dict.fromkeys(said)]
    return Grade(name, tuple(checks), (*found, *faults.told), tracebacks=tuple(faults.tracebacks))


def _notes(part: str, records: Mapping[str, Record], plan: Plan, checks: Sequence[CheckResult]) -> List[str]:
    """What to say about a part besides its checks."""
    said = [*_end_of(part, records, plan), *about_pending(records, plan.limits), *_programs(records)]
    if any(check.outcome is not Outcome.PASSED for check in checks):
        said += [*_unpublished(records), *_wrong_types(records, checks)]
    return said


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


def _with_reasons(results: List[CheckResult], records: Mapping[str, Record], faults: Faults) -> List[CheckResult]:
    """One part's results, each of which names the check with which its failure began."""
    failed = {result.name: result for result in results if result.failure is not None}
    failures = {name: it.failure for name, it in failed.items() if it.failure is not None}
    where = {name: records[it.scenario] for name, it in failed.items() if it.scenario in records}
    table = Reasons(failures, where, faults)
    first = first_reasons({it.name: table.of(it.name) for it in results if it.outcome is not Outcome.PASSED})
    return [replace(it, follows="" if first.get(it.name, it.name) == it.name else first[it.name]) for it in results]


def _judge(check: CheckPlan, plan: Plan, records: Mapping[str, Record], problem: str, faults: Faults) -> CheckResult:
    """A check fails if it fails in one scenario, and passes if it passes in at least one."""
    judged, contract = CHECKS[check.name], CHECKS[check.name].contract
    result = CheckResult(check.name, check.part, contract, Outcome.NOT_REACHED, 0.0, check.points, check.extra)
    for name in check.scenarios:
        verdict: Verdict = NotReached(NOT_STARTED)
        what = f"{check.name} in scenario {name}"
        if name in records:
            unjudged: Verdict = NotReached(NOT_JUDGED)
            verdict = faults.tried(what, unjudged, judged, records[name], plan.limits)
            result = replace(result, scenario=result.scenario or name)
        elif problem:
            verdict = Failed("a complete scenario", "an incomplete one", 0.0, problem, Kind.INCOMPLETE)
        if isinstance(verdict, Failed):
            if judged.explain and name in records:
                unexplained = replace(verdict, cause=sentences(verdict.cause, NOT_EXPLAINED))
                examined = [it for it in check.scenarios if it in records]
                verdict = faults.tried(f"the cause of {what}", unexplained, judged.explain, records, examined, verdict)
            return replace(result, outcome=Outcome.FAILED, points=0.0, scenario=name, failure=verdict, why="")
        if isinstance(verdict, Passed):
            result = replace(result, outcome=Outcome.PASSED, points=check.points, why="")
        elif result.outcome is Outcome.NOT_REACHED:
            result = replace(result, why=result.why or verdict.why)
    return result
