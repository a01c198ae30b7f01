"""What a bridge reports of its goals: how often, whether reports say something, and whether they tell a goal's end."""

import math
import re
from collections import Counter
from statistics import median
from typing import List, NamedTuple, Optional, Sequence, Set, Tuple

from ..handout import Limits
from ..record import ACTIVE, LOST, PENDING, STATUS_NAMES, Line, Record
from .verdict import Failed, Kind

SAME_REPORT = 0.15  # [s] lines within this time of a report's first line belong to it
STATE_NAME = re.compile(rf"\b(?:{'|'.join(STATUS_NAMES)})\b")
STATE = re.compile(  # its name or number
    rf"{STATE_NAME.pattern}|\b(?:state|status|stav)\b\D{{0,5}}\b[0-9]\b|^published on \S+: [0-9]$", re.IGNORECASE
)
# How a recorded line begins: as rospy writes it to a terminal, as recorded from /rosout, or a published report.
BEGIN = re.compile(r"^(?:\x1b\[[\d;]*m)*(?:\[ *[A-Z]+\] ?(?:\[[\d., ]+\]:? ?)?|published on \S+: )?")
# A label without a value or with an empty one, or a function that was not called.
NOTHING = re.compile(r"(?:[^:=,;]*[:=]\s*)?(?:None|\'\'|\"\")?\W*|[^:=,;]*\bNone\W*|.*<(?:bound method|function) .*")
WORD = re.compile(r"[^\W\d_]+|\d+")
SETTLED = 0.3  # [s] after a change, in which a report may still be of the state before
SHORTEST = 1.0  # [s] a state that lasts less than this is not compared with reports
RUNNING = (PENDING, ACTIVE)
SAYS_NOTHING = "The reports say nothing about the state"
TOO_FEW = (
    "Too little is logged, printed or published about the state while a goal is active: a rospy.Timer has to report it "
    "repeatedly, also when it has not changed"
)
SAME_WORDS = "The reports do not tell a goal that is active from one that has succeeded, was aborted or was preempted"
REPORTS_END = "Nothing is reported while this goal is active, although reports came for earlier goals"


def _content(line: Line) -> str:
    return BEGIN.sub("", line.text.strip(), count=1)


def _says_nothing(line: Line) -> bool:
    return bool(NOTHING.fullmatch(_content(line)))


def _between(record: Record, start: float, end: float) -> List[Line]:
    return [line for line in record.lines if start < line.time < end]


def _grouped(lines: Sequence[Line]) -> List[List[Line]]:
    """The lines of each report."""
    reports: List[List[Line]] = []
    for line in lines:
        if not reports or line.time - reports[-1][0].time > SAME_REPORT:
            reports.append([])
        reports[-1].append(line)
    return reports


def wrong_reports(record: Record, limits: Limits) -> Optional[Failed]:
    """The failure: too few reports while a goal is active, or reports that do not tell its end or name other states."""
    start = record.marks["watching"]
    lines = _between(record, start + 0.2, record.marks.get("watched", math.inf))
    count = len(_grouped([line for line in lines if not _says_nothing(line)]))
    if count >= limits.status_reports:
        return _reports_stopped(record, _grouped(lines)) or _wrong_state_reported(record)
    wanted = f"{limits.status_reports} reports within {limits.status_span:g} s"
    if len(_grouped(lines)) >= limits.status_reports:
        empty = next(line for line in lines if _says_nothing(line))
        return Failed(wanted, f"{count}", empty.time, f'{SAYS_NOTHING}, as in "{_content(empty)}"')
    return Failed(wanted, f"{count}", start, TOO_FEW, Kind.NO_REPORT)


class Report(NamedTuple):
    """Lines that name or number states: when [s], names in actionlib's spelling, the words, single and in pairs."""

    time: float
    names: Set[str]
    words: Set[Tuple[str, ...]]


class StateInterval(NamedTuple):
    """From when until when [s] the newest goal is in a state, and what is reported then."""

    start: float
    end: float
    true: int
    reports: List[Report]

    def wrong_names(self) -> List[Report]:
        """The reports with one name only, of another state; a goal that has ended may be PENDING or LOST as well."""
        right = {STATUS_NAMES[it] for it in ((self.true,) if self.true in RUNNING else (self.true, PENDING, LOST))}
        return [it for it in self.reports if len(it.names) == 1 and not it.names & right]

    def told(self) -> Set[Tuple[str, ...]]:
        """The words in most of its reports but the first one, which may be late."""
        counts = Counter(word for report in self.reports[1:] for word in report.words)
        return {word for word, count in counts.items() if 2 * count > len(self.reports) - 1}


def _report(lines: Sequence[Line]) -> Report:
    words: Set[Tuple[str, ...]] = set()
    for line in lines:
        found = WORD.findall(_content(line).lower())
        words.update(zip(found), zip(found, found[1:]))
    return Report(lines[0].time, {name for line in lines for name in STATE_NAME.findall(line.text)}, words)


def _state_intervals(record: Record) -> List[StateInterval]:
    """The intervals of at least SHORTEST, in their order, in which the newest goal stays in one state."""
    numbers = {goal.id: number for number, goal in enumerate(record.goals)}
    changes, newest = [], 0
    for change in sorted(record.statuses, key=lambda change: change.time):
        if numbers.get(change.id, -1) >= newest:
            newest = numbers[change.id]
            changes.append(change)
    ends = [*(change.time for change in changes[1:]), math.inf]
    found = []
    for it, end in zip(changes, ends):
        if end - it.time >= SHORTEST:
            groups = _grouped(_between(record, it.time + SETTLED, end - 1e-6))
            named = [lines for lines in groups if any(STATE.search(one.text) for one in lines)]
            found.append(StateInterval(it.time, end, it.status, [_report(lines) for lines in named]))
    return found


def _wrong_state_reported(record: Record) -> Optional[Failed]:
    """The failure if reports that name states, or number them, are the same after a goal's end, or are untrue.

    What is told of running goals has to differ from what is told of ended ones, in whatever words. Beyond that, only a
    report whose single name in actionlib's spelling is that of another state is untrue, unless no other name occurs.
    """
    intervals = [it for it in _state_intervals(record) if len(it.reports) > 1]  # one alone may be late
    single = set().union(*(report.names for it in intervals for report in it.reports if len(report.names) == 1))
    running = [it.told() for it in intervals if it.true in RUNNING]
    ended = [it.told() for it in intervals if it.true not in RUNNING]
    differs = bool(running and ended) and bool(
        set.intersection(*running).difference(*ended) or set.intersection(*ended).difference(*running)
    )
    if len(single) < 2 and differs:
        return None
    for it in intervals:
        wrong, true = it.wrong_names(), STATUS_NAMES[it.true]
        if len(wrong) > 1 and 2 * len(wrong) >= len(it.reports):
            name = min(wrong[0].names)
            return Failed(true, name, wrong[0].time, f"The bridge reports {name} while the newest goal is {true}")
    if len(single) < 2 and running and ended:
        time = next(it.start for it in intervals if it.true not in RUNNING)
        return Failed("another report after the goal's end", "the same", time, SAME_WORDS)
    return None


def _reports_stopped(record: Record, reports: Sequence[Sequence[Line]]) -> Optional[Failed]:
    """The failure of a bridge that reports nothing of a later goal; `reports`: those of the first one."""
    began = [lines[0].time for lines in reports]
    period = median([later - time for time, later in zip(began, began[1:])] or [math.inf])
    for it in _state_intervals(record):
        watched = it.true == ACTIVE and 2.0 * period + SETTLED < it.end - it.start < math.inf
        if watched and not _between(record, it.start + SETTLED, it.end):
            return Failed("reports of each goal", "none", it.start, REPORTS_END, Kind.NO_REPORT)
    return None
