"""Applies the checks of a plan to records: each check gets an outcome, points and a reason."""

from dataclasses import replace
from typing import List, Mapping, Sequence

from .checks import CHECKS, Failed, NotReached, Passed, Verdict
from .checks.verdict import Kind
from .faults import Faults
from .grades import CheckOutcome, CheckResult, Grade
from .plan import CheckPlan, Plan
from .reasons import NOT_EXPLAINED, with_reasons
from .record import Record
from .texts import sentences

FIRST = "action_server"  # the check without which no other one of a server is reached
ALIVE = "stays_alive"
NOT_STARTED = "the server did not start"
NOT_JUDGED = "the grader failed when it judged this"
PROGRAMS = "in a grading, the processes that a node starts find no ROS master; use rospy in the node itself"
TRUTH = "; the position comes from /odom, as on a real robot"

Records = Mapping[str, Mapping[str, Record]]  # part -> scenario -> record


def judge(name: str, plan: Plan, records: Records, problems: Mapping[str, str]) -> Grade:
    """Grade the parts that have records; `problems` (part -> text) explains records that are missing."""
    checks: List[CheckResult] = []
    faults = Faults()
    for part, by_name in records.items():
        own = [_judge(it, plan, by_name, problems.get(part, ""), faults) for it in plan.checks if it.part == part]
        checks += faults.tried("what follows from what", own, with_reasons, own, by_name, faults)
    found = [f"{part}: {problem}" for part, problem in problems.items() if problem]
    notes: List[str] = []
    for part, by_name in records.items():
        nothing: List[str] = []
        found += [
            f"{part}: {it}" for it in faults.tried(f"the end of the {part}", nothing, _end_of, part, by_name, plan)
        ]
        own = [check for check in checks if check.part == part]
        said = faults.tried(f"notes about the {part}", nothing, _notes, by_name, plan, own)
        notes += [f"{part}: {it}" for it in dict.fromkeys(said)]
    return Grade(name, tuple(checks), (*found, *faults.problems), tuple(notes), tracebacks=tuple(faults.tracebacks))


def _notes(records: Mapping[str, Record], plan: Plan, checks: Sequence[CheckResult]) -> List[str]:
    """What to say about a part besides its checks."""
    said = _programs(records)
    if any(check.outcome is not CheckOutcome.PASSED for check in checks):
        said += _unpublished(records)
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


def _judge(check: CheckPlan, plan: Plan, records: Mapping[str, Record], problem: str, faults: Faults) -> CheckResult:
    """A check fails if it fails in one scenario, and passes if it passes in at least one."""
    judged, contract = CHECKS[check.name], CHECKS[check.name].contract
    result = CheckResult(check.name, check.part, contract, CheckOutcome.NOT_REACHED, 0.0, check.points, check.extra)
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
            return replace(result, outcome=CheckOutcome.FAILED, points=0.0, scenario=name, failure=verdict, why="")
        if isinstance(verdict, Passed):
            result = replace(result, outcome=CheckOutcome.PASSED, points=check.points, why="")
        elif result.outcome is CheckOutcome.NOT_REACHED:
            result = replace(result, why=result.why or verdict.why)
    return result
