"""What a bridge reports of its goals: how often, whether reports say something, and whether they follow the truth."""

import math
import re
from collections import Counter
from statistics import median
from typing import FrozenSet, List, NamedTuple, Optional, Sequence, Set, Tuple

from ..handout import Limits
from ..record import ACTIVE, LOST, PENDING, STATUS_NAMES, Line, Record
from .verdict import Failed, Kind

SAME_REPORT = 0.15  # [s] lines within this time of a report's first line belong to it
STATES = re.compile(rf"\b({'|'.join(STATUS_NAMES)})\b")
NUMBER = re.compile(r"\b(?:state|status|stav)\b\D{0,5}\b([0-9])\b|^published on \S+: ([0-9])$", re.IGNORECASE)
MISNAMED_PENDING = "_has_header"  # actionlib's GoalStatus.to_string(0): the message class has this constant, too: False
# How a recorded line begins: as rospy writes it to a terminal, as recorded from /rosout, or a published report.
BEGIN = re.compile(r"^(?:\x1b\[[\d;]*m)*(?:\[ *[A-Z]+\] ?(?:\[[\d., ]+\]:? ?)?|published on \S+: )?")
UNCALLED = re.compile(r"<(?:bound method|function) [^>]*>*")
# A label without a value, or with an empty one.
NOTHING = re.compile(r"(?:[^:=,;]*[:=]\s*)?(?:None|\'\'|\"\")?\W*|[^:=,;]*\bNone\W*")
WORD = re.compile(r"[^\W\d_]+|\d+")
SETTLED = 0.3  # [s] after a change, in which a report may still be of the state before
SHORTEST = 1.0  # [s] a state that lasts less than this is not compared with reports
RUNNING = (PENDING, ACTIVE)
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
EARLIER_GOAL = (
    "The bridge reports {}, the state of an earlier goal, while the newest goal is {}: report what get_state() "
    "returns. Is it the first entry of status_list, the oldest goal's, or does a timer of the earlier goal go on?"
)
REPORTS_END = (
    "Nothing is reported while this goal is active, although reports came for earlier goals: does the timer end "
    "with an earlier goal, for example by an exception for a state that it does not expect?"
)


def _content(line: Line) -> str:
    return BEGIN.sub("", line.text.strip(), count=1)


def _says_nothing(line: Line) -> bool:
    content = _content(line)
    return bool(UNCALLED.search(content) or NOTHING.fullmatch(content))


def _between(record: Record, start: float, end: float) -> List[Line]:
    return [line for line in record.lines if start < line.time < end]


def _watched(record: Record) -> List[Line]:
    return _between(record, record.marks["watching"] + 0.2, record.marks.get("watched", math.inf))


def is_silent(record: Record, limits: Limits) -> bool:
    """Return whether nothing is said any more at the end of the time in which reports are watched."""
    watched = record.marks["watched"]
    return all(map(_says_nothing, _between(record, watched - limits.status_period - 0.5, watched)))


def _began(lines: List[Line]) -> List[float]:
    """When each report began [s]."""
    reports: List[float] = []
    for line in lines:
        if not reports or line.time - reports[-1] > SAME_REPORT:
            reports.append(line.time)
    return reports


def wrong_reports(record: Record, limits: Limits) -> Optional[Failed]:
    """The failure: too few reports while a goal is active, or untrue reports."""
    start, lines = record.marks["watching"], _watched(record)
    count = len(_began([line for line in lines if not _says_nothing(line)]))
    if count >= limits.status_reports:
        return _reports_stopped(record, _began(lines)) or wrong_state_reported(record)
    wanted = f"{limits.status_reports} reports within {limits.status_span:g} s"
    if len(_began(lines)) >= limits.status_reports:
        empty = next(line for line in lines if _says_nothing(line))
        uncalled = UNCALLED.search(_content(empty))
        cause = UNCALLED_REPORT if uncalled else f'{SAYS_NOTHING}, as in "{_content(empty)}": {REPORT}'
        return Failed(wanted, f"{count}", empty.time, cause)
    cause = REPORTED_ONCE if count else NOTHING_REPORTED
    return Failed(wanted, f"{count}", start, cause, Kind.NO_REPORT)


class Report(NamedTuple):
    """A line that names states: when [s], their names, or numbers if it has no names, the states, all its words.

    Each word comes with how often it is in the line, because a state's number may also be in a list of all numbers.
    """

    time: float
    named: Tuple[str, ...]
    states: Set[int]
    words: FrozenSet[Tuple[str, int]]

    @property
    def is_by_name(self) -> bool:
        """Return whether it has names of states."""
        return not self.named[0].isdigit()


class StateInterval(NamedTuple):
    """From when until when [s] the newest goal is in a state, and what is reported then."""

    start: float
    end: float
    true: int
    reports: List[Report]

    def wrong_reports(self) -> List[Report]:
        """The reports that name other states only; a goal that has ended may be called PENDING or LOST as well."""
        right = {self.true} if self.true in RUNNING else {self.true, PENDING, LOST}
        return [it for it in self.reports if not it.states & (right if it.is_by_name else {self.true})]

    def is_mostly_wrong(self) -> bool:
        """Return whether half of several reports are wrong, or more; one alone may be late."""
        wrong = len(self.wrong_reports())
        return 2 * wrong > len(self.reports) or (wrong > 1 and 2 * wrong == len(self.reports))

    def frequent_words(self) -> Set[Tuple[str, int]]:
        """The words in most of its reports."""
        counts = Counter(word for report in self.reports for word in report.words)
        return {word for word, count in counts.items() if 2 * count > len(self.reports)}


def _report(line: Line) -> Report:
    text = line.text.replace(MISNAMED_PENDING, STATUS_NAMES[PENDING])
    named = STATES.findall(text.upper()) or [one or other for one, other in NUMBER.findall(text)]
    states = {int(it) if it.isdigit() else STATUS_NAMES.index(it) for it in named}
    words = Counter(WORD.findall(_content(line).lower()))
    return Report(line.time, tuple(named), states, frozenset(words.items()))


def _state_intervals(record: Record) -> List[StateInterval]:
    """The intervals of at least SHORTEST, in their order, in which the newest goal stays in one state."""
    numbers = {goal.id: number for number, goal in enumerate(record.goals)}
    changes, newest = [], 0
    for change in sorted(record.statuses, key=lambda change: change.time):
        if numbers.get(change.id, -1) >= newest:
            newest = numbers[change.id]
            changes.append(change)
    reports = [report for report in map(_report, record.lines) if report.named]
    ends = [*(change.time for change in changes[1:]), math.inf]
    return [
        StateInterval(
            it.time, end, it.status, [report for report in reports if it.time + SETTLED < report.time < end - 1e-6]
        )
        for it, end in zip(changes, ends)
        if end - it.time >= SHORTEST
    ]


def _follow_the_truth(intervals: Sequence[StateInterval]) -> bool:
    """Return whether some word, in whatever language, tells a goal that is running from one that has ended."""
    running = [it.frequent_words() for it in intervals if it.reports and it.true in RUNNING]
    ended = [it.frequent_words() for it in intervals if it.reports and it.true not in RUNNING]
    if not running or not ended:
        return False
    return bool(set.intersection(*running).difference(*ended) or set.intersection(*ended).difference(*running))


def _state_names(states: Set[int]) -> str:
    return " ".join(STATUS_NAMES[state] for state in sorted(states))


def wrong_state_reported(record: Record) -> Optional[Failed]:
    """The failure if, in some interval with two reports or more, most of them name other states.

    Only reports with actionlib's names or numbers are judged. A bridge that always names the same state passes if its
    other words tell a running goal from one that has ended.
    """
    intervals = _state_intervals(record)
    named = [{frozenset(one.states) for one in it.reports if len(one.states) > 1} for it in intervals if it.reports]
    legend = set.intersection(*named) if len(named) > 1 else set()
    others = [it._replace(reports=[one for one in it.reports if one.states not in legend]) for it in intervals]
    cause = "" if any(it.reports for it in others) or not legend else SEVERAL_STATES
    intervals = intervals if cause else others
    wrong = [it for it in intervals if len(it.reports) > 1 and (cause or it.is_mostly_wrong())]
    names = {report.named for it in intervals for report in it.reports if report.is_by_name}
    if not wrong or len(names) < 2 and _follow_the_truth(intervals):
        return None
    first = wrong[0].reports[0] if cause else wrong[0].wrong_reports()[0]
    seen = ", ".join(dict.fromkeys(_state_names(report.states) for report in wrong[0].reports))
    cause = cause or _untrue_cause(record, intervals, wrong[0])
    return Failed(STATUS_NAMES[wrong[0].true], seen, first.time, cause)


def _untrue_cause(record: Record, intervals: Sequence[StateInterval], wrong: StateInterval) -> str:
    """Which mistake explains that other states than the true one are reported."""
    first, true = wrong.wrong_reports()[0], STATUS_NAMES[wrong.true]
    shifts = {state - it.true for it in intervals for report in it.reports for state in report.states}
    if len(shifts) == 1 and len({it.true for it in intervals if it.reports}) > 1:
        return f"The names of the states are shifted: {_state_names(first.states)} is reported for {true}; {NUMBERS}"
    newest = max((goal.time for goal in record.goals if goal.time <= wrong.start), default=0.0)
    earlier = {it.id: it.status for it in record.statuses if it.time <= newest and it.status not in RUNNING}
    if wrong.true in RUNNING and earlier and first.states <= {LOST, *earlier.values()}:
        return EARLIER_GOAL.format(_state_names(first.states), true)
    return f"The bridge reports {_state_names(first.states)} while the goal is {true}: {REPORT}"


def _reports_stopped(record: Record, began: List[float]) -> Optional[Failed]:
    """The failure of a bridge that reports nothing of a later goal; `began`: its reports of the first one [s]."""
    period = median([later - time for time, later in zip(began, began[1:])] or [math.inf])
    for it in _state_intervals(record):
        watched = it.true == ACTIVE and 2.0 * period + SETTLED < it.end - it.start < math.inf
        if watched and not _between(record, it.start + SETTLED, it.end):
            return Failed("reports of each goal", "none", it.start, REPORTS_END, Kind.NO_REPORT)
    return None
