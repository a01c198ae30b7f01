"""The bridge: RViz's clicks become goals, and a person hears of it."""

import math
from typing import List, Optional

from ..plan import Limits
from ..record import Click, Goal, Line, Record
from .life import no_exception, stays_alive
from .verdict import Failed, NotReached, Passed, Verdict, check

NEAR = 0.02  # [m] of a forwarded goal
FRAME_NEAR = 0.1  # [m] of a transformed one: a moment's odometry
SAME = 0.15  # [s] lines that come together are one report


def _after(record: Record, click: Click, until: float = math.inf) -> List[Goal]:
    return [goal for goal in record.goals if click.time - 1e-6 <= goal.time <= until]


def _off(goal: Goal, x: float, y: float) -> float:
    return math.hypot(goal.x - x, goal.y - y)


@check("clicks")
def forwards_goal(record: Record, limits: Limits) -> Verdict:
    """A 2D Nav Goal becomes a goal of robocop_goto_as, once, with the same position."""
    if not record.clicks:
        return NotReached("there was no click")
    click = record.clicks[-1]
    goals = _after(record, click)
    if not goals:
        return Failed(
            f"a goal at x {click.x:g} y {click.y:g}",
            "no goal",
            click.time,
            _why_nothing(record),
        )
    goal = goals[-1]
    if not _off(goal, click.x, click.y) <= NEAR:  # which NaN is not either
        return Failed(
            f"x {click.x:g} y {click.y:g}",
            f"x {goal.x:.2f} y {goal.y:.2f}",
            goal.time,
            "the goal's position is not that of the message: goal.position = msg.pose.position",
        )
    if len(goals) > 1:
        return Failed("one goal", f"{len(goals)} goals", goals[1].time, "the click is sent more than once")
    return Passed()


def _why_nothing(record: Record) -> str:
    """Which connection lacks, if one does; a bridge that waits for a server of another name has none."""
    if not record.marks.get("clients", 1.0):
        return "the client did not connect to robocop_goto_as: is its name right?"
    if not record.marks.get("listeners", 1.0):
        return "nothing listens to /move_base_simple/goal"
    return "nothing was sent: is send_goal() called?"


@check("clicks")
def reports_status(record: Record, limits: Limits) -> Verdict:
    """A timer reports on the status of the action server periodically."""
    if "watching" not in record.marks:
        return NotReached("the bridge did not come so far")
    start = record.marks["watching"]
    reports = _reports([line for line in record.lines if line.time > start + 0.2])
    if len(reports) >= limits.status_reports:
        return Passed()
    return Failed(
        f"{limits.status_reports} reports within {limits.status_span:g} s",
        f"{len(reports)}",
        start,
        "create a rospy.Timer whose callback logs, prints or publishes the client's state; a report has to come while "
        "a goal is being pursued, again and again",
    )


def _reports(lines: List[Line]) -> List[float]:
    """Times of reports: what comes together is one."""
    times: List[float] = []
    for line in lines:
        if not times or line.time - times[-1] > SAME:
            times.append(line.time)
    return times


@check("clicks")
def cancels_older(record: Record, limits: Limits) -> Verdict:
    """A newer 2D Nav Goal cancels the older goal, and is sent itself."""
    if not record.clicks or not any(goal.time < record.clicks[0].time for goal in record.goals):
        return NotReached("there was no older goal")
    click = record.clicks[0]
    older = next(goal for goal in record.goals if goal.time < click.time)
    newer = [goal for goal in _after(record, click) if goal.id != older.id]
    cancelled = [status.id for status in record.statuses]
    if not newer:
        return Failed("the newer goal is sent", "no goal", click.time, "the newer goal was never sent")
    if older.id not in cancelled:
        return Failed(
            "the older goal is cancelled",
            "no cancel came",
            click.time,
            "cancel_goal() or cancel_all_goals() lacks before the newer goal is sent: send_goal() alone does not "
            "cancel",
        )
    if newer[-1].id in cancelled:
        return Failed(
            "only the older goal is cancelled",
            "the newer one was cancelled as well",
            newer[-1].time,
            "cancel before send_goal, not after it",
        )
    return Passed()


@check("clicks")
def waits_for_server(record: Record, limits: Limits) -> Verdict:
    """The bridge survives that the server comes later, and then works."""
    if record.name == "no_server":
        return _lives(record, limits) or Passed()
    click = record.clicks[-1] if record.clicks else None
    if click is None or not _after(record, click):
        return Failed(
            "a goal once the server is there",
            "no goal",
            record.marks.get("clicked", 0.0),
            "a bridge that starts before the server has to find it later: wait_for_server() without giving up",
        )
    return Passed()


@check("clicks")
def bridge_alive(record: Record, limits: Limits) -> Verdict:
    """The bridge is alive at the end, without an exception."""
    return _lives(record, limits) or Passed()


def _lives(record: Record, limits: Limits) -> Optional[Failed]:
    for verdict in (stays_alive(record, limits), no_exception(record, limits)):
        if isinstance(verdict, Failed):
            return verdict
    return None


@check("clicks")
def goal_frame(record: Record, limits: Limits) -> Verdict:
    """A goal given in another frame is transformed to odom: the handout's closing question."""
    if not record.clicks:
        return NotReached("there was no click")
    for number, click in enumerate(record.clicks):
        until = record.clicks[number + 1].time if number + 1 < len(record.clicks) else math.inf
        goals = _after(record, click, until)
        if not goals:
            return Failed(
                f"a goal for the click in {click.frame}", "no goal", click.time, "the click was not forwarded"
            )
        if not _off(goals[-1], click.odom_x, click.odom_y) <= FRAME_NEAR:
            raw = _off(goals[-1], click.x, click.y) < NEAR
            return Failed(
                f"x {click.odom_x:.2f} y {click.odom_y:.2f} in odom",
                f"x {goals[-1].x:.2f} y {goals[-1].y:.2f}",
                goals[-1].time,
                f"numbers given in {click.frame} were passed on as if they were in odom: "
                "header.frame_id says which frame it is, tf2 transforms it"
                if raw
                else "the transform is wrong",
            )
    return Passed()
