"""How a bridge reports its goal's state: how often, whether reports name a state, and whether the state is true."""

import re
from typing import List, NamedTuple, Optional, Set, Tuple

from ..handout import Limits
from ..record import ACTIVE, LOST, PENDING, STATUS_NAMES, SUCCEEDED, Line, Record
from .verdict import Failed, Kind

SAME_REPORT = 0.15  # [s] lines within this time of a report's first line belong to it
STATES = re.compile(rf"\b({'|'.join(STATUS_NAMES)})\b", re.IGNORECASE)
NUMBER = re.compile(r"\b(?:state|status)\b\D{0,5}\b([0-9])\b|^published on \S+: ([0-9])$", re.IGNORECASE)
PENDING_AS_TOLD = "_has_header"  # actionlib's GoalStatus.to_string(0): the message class has this constant, too: False
# How a recorded line begins: as rospy writes it to a terminal, as recorded from /rosout, or a published report.
BEGIN = re.compile(r"^(?:\x1b\[[\d;]*m)*(?:\[ *[A-Z]+\] ?(?:\[[\d., ]+\]:? ?)?|published on \S+: )?")
UNCALLED = re.compile(r"<(?:bound method|function) [^>]*>*")
# A label without a value, or with an empty one.
NOTHING = re.compile(r"(?:[^:=,;]*[:=]\s*)?(?:None|\'\'|\"\")?\W*|[^:=,;]*\bNone\W*")
SETTLED = 0.3  # [s] after a change, in which a report may still be of the state before
MOSTLY = 0.8
SOMETIMES = 0.3  # share of reports that name the same states whatever the true one is
DONE = 7  # the number of actionlib's CommState for a goal that has ended, in which ACTIVE is 2
CLIENT_ACTIVE = 2
REPORT = "report what get_state() returns"
SAYS_NOTHING = "The reports say nothing about the state"
UNCALLED_REPORT = (
    "The report shows a function instead of the state: the parentheses of its call are missing, as in get_state()"
)
REPORTED_ONCE = (
    "The status is not reported repeatedly while a goal is active: is the rospy.Timer's period too long, does anything "
    "end it, or does it only report changes?"
)
NOTHING_REPORTED = (
    "Nothing is logged, printed or published about the state while a goal is active: a rospy.Timer has to report it "
    "repeatedly, also when it has not changed"
)
SEVERAL_STATES = (
    "A report that names several states says nothing if it names the same ones whatever the true one is: report the "
    "state that get_state() returns, and no other one"
)
NUMBERS = "GoalStatus has PENDING = 0, ACTIVE = 1, PREEMPTED = 2, SUCCEEDED = 3, ABORTED = 4"


def _content(line: Line) -> str:
    return BEGIN.sub("", line.text.strip(), count=1)


def _says_nothing(line: Line) -> bool:
    content = _content(line)
    return bool(UNCALLED.search(content) or NOTHING.fullmatch(content))


def _began(lines: List[Line]) -> List[float]:
    """When each report began [s]."""
    reports: List[float] = []
    for line in lines:
        if not reports or line.time - reports[-1] > SAME_REPORT:
            reports.append(line.time)
    return reports


def wrong_reports(record: Record, limits: Limits) -> Optional[Failed]:
    """Name the failure: too few reports while a goal is active, or untrue reports."""
    start = record.marks["watching"]
    lines = [line for line in record.lines if start + 0.2 < line.time < record.marks.get("watched", float("inf"))]
    count = len(_began([line for line in lines if not _says_nothing(line)]))
    if count >= limits.status_reports:
        return _untrue(record)
    wanted = f"{limits.status_reports} reports within {limits.status_span:g} s"
    if len(_began(lines)) >= limits.status_reports:
        empty = next(line for line in lines if _says_nothing(line))
        uncalled = UNCALLED.search(_content(empty))
        cause = UNCALLED_REPORT if uncalled else f'{SAYS_NOTHING}, as in "{_content(empty)}": {REPORT}'
        return Failed(wanted, f"{count}", empty.time, cause, Kind.EMPTY_REPORT)
    cause = REPORTED_ONCE if count else NOTHING_REPORTED
    return Failed(wanted, f"{count}", start, cause, Kind.NO_REPORT)


class Report(NamedTuple):
    """A report of a goal's state: when [s], the states that it names, whether by numbers, and the true state."""

    time: float
    states: Set[int]
    by_number: bool
    true: int
    named: Tuple[str, ...] = ()  # states and numbers in the order in which it names them

    @property
    def is_true(self) -> bool:
        """Return whether the report names the true state.

        When the goal has succeeded, a report is untrue only if it contradicts the success. Its numbers may then come
        from another enumeration than actionlib's.
        """
        if self.true != SUCCEEDED:
            return self.true in self.states
        return self.states != {ACTIVE} if self.by_number else bool(self.states & {SUCCEEDED, PENDING, LOST})


def _stated(record: Record) -> List[Report]:
    """The reports that name a state, while the newest goal is PENDING, ACTIVE or SUCCEEDED, each once."""
    changes = sorted(record.statuses, key=lambda change: change.time)
    found: List[Report] = []
    for line in record.lines:
        before = [change for change in changes if change.time <= line.time + 1e-6]
        told = line.text.replace(PENDING_AS_TOLD, STATUS_NAMES[PENDING])
        words, figures = STATES.findall(told), [one or other for one, other in NUMBER.findall(line.text)]
        names, numbers = {STATUS_NAMES.index(name.upper()) for name in words}, set(map(int, figures))
        judged = before and before[-1].status in (PENDING, ACTIVE, SUCCEEDED) and line.time > before[-1].time + SETTLED
        if (names or numbers) and judged and not (found and line.time - found[-1].time <= SAME_REPORT):
            named = (*map(str.upper, words), *figures)
            found.append(Report(line.time, names or numbers, not names, before[-1].status, named))
    return found


def _is_client_state(reports: List[Report]) -> bool:
    """Return whether the numbers are those of actionlib's CommState."""
    ended = [report.states for report in reports if report.true == SUCCEEDED and report.by_number]
    active = [report.states for report in reports if report.true == ACTIVE and report.by_number]
    return bool(ended) and all(DONE in it for it in ended) and all(CLIENT_ACTIVE in it for it in active)


def _untrue(record: Record) -> Optional[Failed]:
    """Name the failure of a bridge that reports wrong states; only reports in actionlib's words are judged."""
    reports = _stated(record)
    told = {(report.named, report.true) for report in reports}
    several = [it for it in reports if len(it.states) > 1 and sum(named == it.named for named, _ in told) > 1]
    if len(several) > 1 and len(several) > SOMETIMES * len(reports):
        first = several[0]
        seen = " ".join(STATUS_NAMES[state] for state in sorted(first.states))
        return Failed(STATUS_NAMES[first.true], seen, first.time, SEVERAL_STATES, Kind.UNTRUE_REPORT)
    wrong = [] if _is_client_state(reports) else [report for report in reports if not report.is_true]
    true_states = dict.fromkeys(report.true for report in reports)
    for true in true_states:
        some = [report for report in reports if report.true == true]
        untrue = [report for report in wrong if report.true == true]
        if len(untrue) > 1 and len(untrue) > MOSTLY * len(some) or len(wrong) == len(reports) > 1:
            first = untrue[0]
            names = " ".join(STATUS_NAMES[state] for state in sorted(first.states))
            shifts = {state - report.true for report in reports for state in report.states}
            cause = f"The bridge reports {names} while the goal is {STATUS_NAMES[true]}: {REPORT}"
            if len(true_states) > 1 and len(shifts) == 1:
                cause = f"The names of the states are shifted: {names} is reported for {STATUS_NAMES[true]}; {NUMBERS}"
            return Failed(STATUS_NAMES[true], names, first.time, cause, Kind.UNTRUE_REPORT)
    return None
