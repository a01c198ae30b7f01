"""Checks of the bridge: clicks become goals, and the server's status is reported."""

import math
import re
from typing import List, NamedTuple, Optional, Set

from ..handout import ACTION, CLICKS, Limits
from ..record import PENDING, PREEMPTED, STATUS_NAMES, Click, Goal, Record
from ..texts import text
from .consequences import alike
from .node_lifetime import closest, no_exception, stays_alive
from .verdict import After, Failed, NotReached, Retry, Verdict, check

POSITION_TOLERANCE = 0.02  # [m] of a goal that needs no transform
FRAME_TOLERANCE = 0.1  # [m] of a transformed goal: the robot moves between two odometry messages
SAME_REPORT = 0.15  # [s] lines within this time of a report's first line belong to it
MISSING, POSITION, NOT_CANCELLED = "no goal", "another position", "not cancelled"  # kinds of failures
NEEDS = "bridge_alive", "forwards_goal"
CRASH = After("bridge_alive", kind=MISSING)


def _goals_after(record: Record, click: Click, until: float = math.inf) -> List[Goal]:
    return [goal for goal in record.goals if click.time - 1e-6 <= goal.time <= until]


def _distance(goal: Goal, x: float, y: float) -> float:
    return math.hypot(goal.x - x, goal.y - y)


@check("clicks", after=(CRASH,))
def forwards_goal(record: Record, limits: Limits) -> Verdict:
    """A 2D Nav Goal is sent to robocop_goto_as exactly once, with the same position."""
    if not record.clicks:
        return NotReached("there was no click")
    click = record.clicks[-1]
    goals = _goals_after(record, click)
    wanted = text("x {:g} y {:g}", click.x, click.y)
    if not goals:
        return Failed(text("a goal at {}", wanted), "no goal", click.time, _missing_connection(record), MISSING)
    goal = goals[-1]
    if not _distance(goal, click.x, click.y) <= POSITION_TOLERANCE:  # this way round NaN fails, too
        seen = text("x {:.2f} y {:.2f}", goal.x, goal.y)
        return Failed(wanted, seen, goal.time, _other_position(click, goal), POSITION)
    if len(goals) > 1:
        return Failed("one goal", text("{} goals", len(goals)), goals[1].time, "The click is sent more than once")
    return None


def _other_position(click: Click, goal: Goal) -> str:
    """Which mistake explains a goal's position that is not the click's."""
    x, y = click.x, click.y
    for cause, there in (
        ("The goal's position is never set", (0.0, 0.0)),
        ("x and y are swapped", (y, x)),
        ("The goal's y is not set", (x, 0.0)),
        ("The goal's x is not set", (0.0, y)),
        ("The sign of x is wrong", (-x, y)),
        ("The sign of y is wrong", (x, -y)),
        ("The signs of x and y are wrong", (-x, -y)),
    ):
        if _distance(goal, *there) <= POSITION_TOLERANCE:
            return text("{}: set goal.position = msg.pose.position", cause)
    return text("other_position")


def _has_client(record: Record) -> bool:
    """Whether its action client connected to the server."""
    return bool(record.marks.get("clients", 1.0))


def _missing_connection(record: Record) -> str:
    """Name the missing connection, if any."""
    if not _has_client(record):  # first: a bridge waiting for a misspelt server has no subscriber either
        return _unconnected(record)
    if not record.marks.get("listeners", 1.0):
        similar = closest(CLICKS, record.unpublished)
        return text("other_topic", CLICKS, similar) if similar else text("no_subscriber", CLICKS)
    return text("nothing_sent")


def _unconnected(record: Record) -> str:
    """Why no action client connected to the server."""
    name, others = ACTION[1:], [server.lstrip("/") for server in record.servers]
    if not others or name in others:
        return text("unconnected")
    return text("other_action", closest(name, others) or others[0], name)


def _reports(record: Record, until: float = math.inf) -> List[float]:
    """When each report before this time began [s]."""
    start = record.marks["watching"]
    reports: List[float] = []
    for line in record.lines:
        if start + 0.2 < line.time < until and (not reports or line.time - reports[-1] > SAME_REPORT):
            reports.append(line.time)
    return reports


def _reports_without_pending(failure: Failed, retried: Record, limits: Limits) -> bool:
    """Whether enough is reported for a goal that is never PENDING."""
    second_click = retried.clicks[-1].time - 1e-6  # which changes the state
    return failure.kind == MISSING and len(_reports(retried, second_click)) >= limits.status_reports


@check("clicks", after=(CRASH,), needs=NEEDS, retried=Retry("no_pending", _reports_without_pending, "reports_stop"))
def reports_status(record: Record, limits: Limits) -> Verdict:
    """A timer reports the status of the action server periodically."""
    if "watching" not in record.marks:
        return NotReached("the bridge did not get this far")
    count = len(_reports(record))
    if count >= limits.status_reports:
        return _untrue(record)
    if not _has_client(record):  # it may wait for the server before it creates its timer
        return NotReached(_unconnected(record))
    cause = text("reported_once" if count else "nothing_reported")
    wanted = text("{} reports within {:g} s", limits.status_reports, limits.status_span)
    return Failed(wanted, f"{count}", record.marks["watching"], cause, MISSING)


STATES = re.compile(rf"\b({'|'.join(STATUS_NAMES)})\b", re.IGNORECASE)
NUMBER = re.compile(r"\b(?:state|status)\b\D{0,5}\b([0-9])\b|^published on \S+: ([0-9])$", re.IGNORECASE)
PENDING_AS_TOLD = "_has_header"  # actionlib's GoalStatus.to_string(0): the message class has this constant, too: False
SETTLED = 0.3  # [s] after a change, in which a report may still be of the state before
MOSTLY = 0.8


class Report(NamedTuple):
    """A report of a goal's state: when [s], the states that its text names, and the true one."""

    time: float
    states: Set[int]
    true: int


def _stated(record: Record) -> List[Report]:
    """The reports that name a state, while a goal is PENDING or ACTIVE, each once."""
    changes = sorted(record.statuses, key=lambda change: change.time)
    found: List[Report] = []
    for line in record.lines:
        before = [change for change in changes if change.time <= line.time + 1e-6]
        told = line.text.replace(PENDING_AS_TOLD, STATUS_NAMES[PENDING])
        names = {STATUS_NAMES.index(name.upper()) for name in STATES.findall(told)}
        names = names or {int(one or other) for one, other in NUMBER.findall(line.text)}
        known = names and before and before[-1].status <= 1 and line.time > before[-1].time + SETTLED
        if known and not (found and line.time - found[-1].time <= SAME_REPORT):
            found.append(Report(line.time, names, before[-1].status))
    return found


def _untrue(record: Record) -> Optional[Failed]:
    """A bridge that reports other states than the true ones; reports in other words than actionlib's are not judged."""
    reports = _stated(record)
    wrong = [report for report in reports if report.true not in report.states]
    true_states = dict.fromkeys(report.true for report in reports)
    for true in true_states:
        some = [report for report in reports if report.true == true]
        untrue = [report for report in wrong if report.true == true]
        if len(untrue) > 1 and len(untrue) > MOSTLY * len(some) or len(wrong) == len(reports) > 1:
            first = untrue[0]
            names = " ".join(STATUS_NAMES[state] for state in sorted(first.states))
            shifts = {state - report.true for report in reports for state in report.states}
            cause = "shifted_states" if len(true_states) > 1 and len(shifts) == 1 else "untrue_state"
            return Failed(STATUS_NAMES[true], names, first.time, text(cause, names, STATUS_NAMES[true]))
    return None


def _cancels_without_pending(failure: Failed, retried: Record, _limits: Limits) -> bool:
    """Whether an older goal that is never PENDING is cancelled."""
    cancelled = any(cancel.time >= retried.clicks[-1].time - 1e-6 for cancel in retried.cancels)
    return failure.kind == NOT_CANCELLED and cancelled


@check(
    "clicks",
    after=(CRASH, After("forwards_goal", alike)),
    needs=NEEDS,
    retried=Retry("no_pending", _cancels_without_pending, "no_older_goal_seen"),
)
def cancels_older(record: Record, limits: Limits) -> Verdict:
    """A newer 2D Nav Goal cancels the older goal and is then sent itself."""
    if not record.clicks or not any(goal.time < record.clicks[0].time for goal in record.goals):
        return NotReached("there was no older goal")
    click = record.clicks[0]
    older = next(goal for goal in record.goals if goal.time < click.time)
    newer = [goal for goal in _goals_after(record, click) if goal.id != older.id]
    cancelled = [change.id for change in record.statuses if change.status == PREEMPTED]
    if not newer:
        return Failed("the newer goal", "no goal", click.time, text("no_newer_goal"), MISSING)
    x, y = newer[-1].x, newer[-1].y
    if not _distance(newer[-1], click.x, click.y) <= POSITION_TOLERANCE:
        same = _distance(older, x, y) <= POSITION_TOLERANCE
        cause = text("older_position") if same else _other_position(click, newer[-1])
        wanted, seen = text("x {:g} y {:g}", click.x, click.y), text("x {:.2f} y {:.2f}", x, y)
        return Failed(wanted, seen, newer[-1].time, cause, POSITION)
    if newer[-1].id in cancelled:
        seen = "one for both" if older.id in cancelled else "one for the newer goal"
        cause = "Cancel before send_goal(), not after it"
        return Failed("a cancel request for the older goal only", seen, newer[-1].time, cause)
    if older.id not in cancelled:
        wanted = "a cancel request for the older goal"
        return Failed(wanted, "none", click.time, text("cancel_first"), NOT_CANCELLED)
    return None


@check("clicks", after=(CRASH, After("forwards_goal", alike)), needs=NEEDS)
def waits_for_server(record: Record, limits: Limits) -> Verdict:
    """A bridge that is started before the server waits for it, and then works."""
    if record.name == "no_server":
        return _crash(record, limits) or NotReached("the bridge was not tried with a server")
    if record.clicks and _goals_after(record, record.clicks[-1]):
        return None
    if not _has_client(record):
        return NotReached(_unconnected(record))
    clicked, wanted = record.marks.get("clicked", 0.0), "a goal once the server is running"
    return Failed(wanted, "no goal", clicked, text("waits_for_no_server"), MISSING)


@check("clicks")
def bridge_alive(record: Record, limits: Limits) -> Verdict:
    """The bridge runs to the end without an exception."""
    return _crash(record, limits)


def _crash(record: Record, limits: Limits) -> Optional[Failed]:
    for verdict in (stays_alive(record, limits), no_exception(record, limits)):
        if isinstance(verdict, Failed):
            return verdict
    return None


@check("clicks", after=(CRASH, After("forwards_goal", alike), After("cancels_older", alike)), needs=NEEDS)
def goal_frame(record: Record, limits: Limits) -> Verdict:
    """A goal given in another frame is transformed to odom (the handout's closing question)."""
    if not record.clicks:
        return NotReached("there was no click")
    if not record.goals:
        return NotReached("no click became a goal")
    for number, click in enumerate(record.clicks):
        # What a click causes may come without any simulated time passing.
        until = record.clicks[number + 1].time - 1e-3 if number + 1 < len(record.clicks) else math.inf
        goals = _goals_after(record, click, until)
        if not goals:
            wanted, cause = text("a goal for the click in {}", click.frame), "The click was not forwarded"
            return Failed(wanted, "no goal", click.time, cause, MISSING)
        goal = goals[-1]
        if not _distance(goal, click.odom_x, click.odom_y) <= FRAME_TOLERANCE:
            cause = "The transform is wrong"
            if _distance(goal, click.x, click.y) < POSITION_TOLERANCE:
                cause = text("not_transformed", click.frame)
            wanted = text("x {:.2f} y {:.2f} in odom", click.odom_x, click.odom_y)
            return Failed(wanted, text("x {:.2f} y {:.2f}", goal.x, goal.y), goal.time, cause, POSITION)
    return None
