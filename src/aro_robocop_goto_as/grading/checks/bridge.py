"""Checks of the bridge: clicks become goals, and the server's status is reported."""

import math
from typing import List, Optional

from ..check_limits import Limits
from ..record import Click, Goal, Record
from .node_lifetime import no_exception, stays_alive
from .verdict import Earlier, Failed, NotReached, Passed, Verdict, check

POSITION_TOLERANCE = 0.02  # [m] of a goal that needs no transform
FRAME_TOLERANCE = 0.1  # [m] of a transformed goal: the robot moves between two odometry messages
SAME_REPORT = 0.15  # [s] lines within this time of a report's first line belong to it
CRASH = (Earlier("bridge_alive"),)
UNCONNECTED = "No action client connected to robocop_goto_as: is one created, and is its name right?"
NO_NEWER_GOAL = (
    "The newer goal was never sent: does the callback wait for the older goal? While it waits, for instance in "
    "wait_for_result(), it is not called again"
)
PENDING_ENDS = "pending_ends"  # mark: what is missing here appears for a goal that was never seen PENDING
PENDING_CAUSE = (
    "The bridge treats a PENDING goal as finished; PENDING only means that the server has not accepted it yet"
)


def _goals_after(record: Record, click: Click, until: float = math.inf) -> List[Goal]:
    return [goal for goal in record.goals if click.time - 1e-6 <= goal.time <= until]


def _distance(goal: Goal, x: float, y: float) -> float:
    return math.hypot(goal.x - x, goal.y - y)


@check("clicks")
def forwards_goal(record: Record, limits: Limits) -> Verdict:
    """A 2D Nav Goal is sent to robocop_goto_as exactly once, with the same position."""
    if not record.clicks:
        return NotReached("there was no click")
    click = record.clicks[-1]
    goals = _goals_after(record, click)
    wanted = f"x {click.x:g} y {click.y:g}"
    if not goals:
        return Failed(f"a goal at {wanted}", "no goal", click.time, _missing_connection(record), CRASH)
    goal = goals[-1]
    if not _distance(goal, click.x, click.y) <= POSITION_TOLERANCE:  # this way round NaN fails, too
        seen, cause = f"x {goal.x:.2f} y {goal.y:.2f}", "The goal does not have the message's position: "
        return Failed(wanted, seen, goal.time, cause + "set goal.position = msg.pose.position")
    if len(goals) > 1:
        return Failed("one goal", f"{len(goals)} goals", goals[1].time, "The click is sent more than once")
    return Passed()


def _has_client(record: Record) -> bool:
    """Whether its action client connected to the server."""
    return bool(record.marks.get("clients", 1.0))


def _missing_connection(record: Record) -> str:
    """Name the missing connection, if any."""
    if not _has_client(record):  # first: a bridge waiting for a misspelt server has no subscriber either
        return UNCONNECTED
    if not record.marks.get("listeners", 1.0):
        return "The node does not subscribe to /move_base_simple/goal: is the topic's name right?"
    return (
        "No goal was sent: does the callback call send_goal()? Does a bridge that is started before the server wait "
        "for it, with wait_for_server() without a timeout?"
    )


def has_reports(record: Record, limits: Limits) -> bool:
    """Whether the node reported often enough."""
    return len(_reports(record)) >= limits.status_reports


def _reports(record: Record) -> List[float]:
    """When each report began [s]."""
    start = record.marks["watching"]
    reports: List[float] = []
    for line in record.lines:
        if line.time > start + 0.2 and (not reports or line.time - reports[-1] > SAME_REPORT):
            reports.append(line.time)
    return reports


@check("clicks")
def reports_status(record: Record, limits: Limits) -> Verdict:
    """A timer reports the status of the action server periodically."""
    if "watching" not in record.marks:
        return NotReached("the bridge did not get this far")
    if has_reports(record, limits):
        return Passed()
    if not _has_client(record):  # it may wait for the server before it creates its timer
        return NotReached(UNCONNECTED)
    count = len(_reports(record))
    cause = (
        "Nothing is logged, printed or published about the state while a goal is active: a rospy.Timer has to report "
        "it repeatedly, also when it has not changed"
    )
    if count:
        cause = (
            "The status is not reported repeatedly while a goal is active: is the rospy.Timer's period too long, does "
            "anything end it, or does it only report changes?"
        )
    if PENDING_ENDS in record.marks:
        cause = f"{PENDING_CAUSE}. Its reports then stop"
    wanted = f"{limits.status_reports} reports within {limits.status_span:g} s"
    return Failed(wanted, f"{count}", record.marks["watching"], cause, CRASH)


@check("clicks")
def cancels_older(record: Record, limits: Limits) -> Verdict:
    """A newer 2D Nav Goal cancels the older goal and is then sent itself."""
    if not record.clicks or not any(goal.time < record.clicks[0].time for goal in record.goals):
        return NotReached("there was no older goal")
    click = record.clicks[0]
    older = next(goal for goal in record.goals if goal.time < click.time)
    newer = [goal for goal in _goals_after(record, click) if goal.id != older.id]
    cancelled = [status.id for status in record.statuses]
    if not newer:
        return Failed("the newer goal", "no goal", click.time, NO_NEWER_GOAL, CRASH)
    if older.id not in cancelled:
        cause = (
            "Call cancel_goal() or cancel_all_goals() before sending the newer goal; send_goal() alone does not cancel"
        )
        if PENDING_ENDS in record.marks:
            cause = f"{PENDING_CAUSE}. It then sees no older goal to cancel"
        return Failed("a cancel request for the older goal", "none", click.time, cause)
    if newer[-1].id in cancelled:
        cause = "Cancel before send_goal(), not after it"
        return Failed("a cancel request for the older goal only", "one for both", newer[-1].time, cause)
    return Passed()


@check("clicks")
def waits_for_server(record: Record, limits: Limits) -> Verdict:
    """A bridge that is started before the server waits for it, and then works."""
    if record.name == "no_server":
        return _crash(record, limits) or NotReached("the bridge was not tried with a server")
    if record.clicks and _goals_after(record, record.clicks[-1]):
        return Passed()
    if not _has_client(record):
        return NotReached(UNCONNECTED)
    cause = (
        "A bridge that starts before the server has to connect to it later: call wait_for_server() without a timeout"
    )
    clicked, follows = record.marks.get("clicked", 0.0), (*CRASH, Earlier("forwards_goal"))
    return Failed("a goal once the server is running", "no goal", clicked, cause, follows)


@check("clicks")
def bridge_alive(record: Record, limits: Limits) -> Verdict:
    """The bridge runs to the end without an exception."""
    return _crash(record, limits) or Passed()


def _crash(record: Record, limits: Limits) -> Optional[Failed]:
    for verdict in (stays_alive(record, limits), no_exception(record, limits)):
        if isinstance(verdict, Failed):
            return verdict
    return None


@check("clicks")
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
            wanted, cause = f"a goal for the click in {click.frame}", "The click was not forwarded"
            return Failed(wanted, "no goal", click.time, cause, CRASH)
        goal = goals[-1]
        if not _distance(goal, click.odom_x, click.odom_y) <= FRAME_TOLERANCE:
            cause = "The transform is wrong"
            if _distance(goal, click.x, click.y) < POSITION_TOLERANCE:
                cause = (
                    f"Coordinates in {click.frame} were passed on as if they were in odom: use tf2 to transform them "
                    "from header.frame_id to odom"
                )
            wanted, seen = f"x {click.odom_x:.2f} y {click.odom_y:.2f} in odom", f"x {goal.x:.2f} y {goal.y:.2f}"
            return Failed(wanted, seen, goal.time, cause, (Earlier("forwards_goal", "x "),))
    return Passed()
