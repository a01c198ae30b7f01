"""Checks of the bridge: clicks become goals, and the server's status is reported."""

import math
from typing import List, Optional

from ..handout import ACTION, Limits
from ..record import PREEMPTED, RECALLED, Click, Record, SentGoal
from . import bridge_causes as causes
from .bridge_reports import wrong_reports
from .node_lifetime import no_exception, stays_alive
from .topic_use import wrong_type
from .verdict import PASSED, Failed, Kind, NotReached, Verdict, check


def _goals_after(record: Record, click: Click, until: float = math.inf) -> List[SentGoal]:
    return [goal for goal in record.goals if click.time - 1e-6 <= goal.time <= until]


def _goals_of(record: Record, number: int) -> List[SentGoal]:
    """The goals between a click and the next one; what a click causes may come without any simulated time passing."""
    until = record.clicks[number + 1].time - 1e-3 if number + 1 < len(record.clicks) else math.inf
    return _goals_after(record, record.clicks[number], until)


@check("bridge", "click", plot="track")
def forwards_goal(record: Record, limits: Limits) -> Verdict:
    """Each 2D Nav Goal is sent to robocop_goto_as exactly once, with the same position; no other goal is sent."""
    if not record.clicks:
        return NotReached("there was no click")
    for number, click in enumerate(record.clicks):
        goals, wanted = _goals_of(record, number), f"x {click.x:g} y {click.y:g}"
        if not goals:
            cause = causes.NOT_FORWARDED if record.goals else causes.missing_connection(record)
            return Failed(f"a goal at {wanted}", "no goal", click.time, cause, Kind.NO_GOAL)
        goal = goals[-1]
        if not causes.distance(goal, click.x, click.y) <= causes.POSITION_TOLERANCE:  # this way round NaN fails, too
            seen, cause = f"x {goal.x:.2f} y {goal.y:.2f}", causes.other_position(record, click, goal)
            return Failed(wanted, seen, goal.time, cause, Kind.OTHER_POSITION)
        if len(goals) > 1:
            return Failed("one goal", f"{len(goals)} goals", goals[1].time, "The click is sent more than once")
    for goal in record.goals:
        if goal.time < record.clicks[0].time - 1e-6:
            seen = f"a goal at x {goal.x:.2f} y {goal.y:.2f}"
            return Failed("no goal before the first click", seen, goal.time, causes.UNASKED_GOAL)
    if record.servers and ACTION not in record.servers:
        time = record.goals[0].time
        return Failed(f"a goal to {ACTION[1:]}", "one to another action", time, causes.unconnected(record))
    return PASSED


@check("bridge", "click", plot="track")
def reports_status(record: Record, limits: Limits) -> Verdict:
    """A timer reports the status of the action server periodically."""
    if "watching" not in record.marks:
        return NotReached("the bridge did not get this far")
    problem = wrong_reports(record, limits)
    connects = causes.has_client(record) and not wrong_type(record, *causes.ACTION_TOPICS)
    if problem is not None and problem.kind is Kind.NO_REPORT and not connects:
        return NotReached(causes.unconnected(record))  # it may wait for the server before it creates its timer
    return problem or PASSED


def _unasked_cancel(record: Record) -> Optional[Failed]:
    """The failure to leave a goal alone for which no newer click has come."""
    times = {cancel.time for cancel in record.cancels}
    for goal in record.goals:
        end = record.active_until(goal)
        if end in times and not any(goal.time < click.time <= end for click in record.clicks):
            seen = f"one {end - goal.time:.1f} s after the goal"
            return Failed("no cancel request without a newer click", seen, end, causes.UNASKED_CANCEL)
    return None


@check("bridge", "replace click", plot="track")
def cancels_older(record: Record, limits: Limits) -> Verdict:
    """A newer 2D Nav Goal cancels the older goal and is then sent itself; nothing else cancels a goal."""
    if record.name == "click":
        return _unasked_cancel(record) or NotReached("each goal ends before the next click comes")
    if len(record.clicks) < 2:
        return NotReached("there was no newer click")
    before, click = record.clicks[:2]
    goals = _goals_after(record, click)
    old = [goal for goal in _goals_after(record, before) if goal not in goals]
    if not old:
        wanted = f"a goal at x {before.x:g} y {before.y:g}"
        return Failed(wanted, "no goal", before.time, causes.NOT_FORWARDED, Kind.NO_GOAL)
    older, newer = old[-1], [goal for goal in goals if goal.id != old[-1].id]
    cancelled = {change.id for change in record.statuses if change.status in (PREEMPTED, RECALLED)}
    if not newer:
        return Failed("the newer goal", "no goal", click.time, causes.NOT_FORWARDED, Kind.NO_GOAL)
    if newer[-1].id in cancelled:
        seen = "one for both" if older.id in cancelled else "one for the newer goal"
        wanted = "a cancel request for the older goal only"
        return Failed(wanted, seen, newer[-1].time, causes.NEWER_CANCELLED)
    if older.id not in cancelled:
        wanted = "a cancel request for the older goal"
        requests = [cancel for cancel in record.cancels if cancel.time >= click.time - 1e-6]
        seen = "one for another goal" if requests else "none"
        return Failed(wanted, seen, click.time, causes.NOT_CANCELLED, Kind.NOT_CANCELLED)
    return PASSED


@check("bridge", "no_server click", plot="track")
def waits_for_server(record: Record, limits: Limits) -> Verdict:
    """A bridge that is started before the server waits for it, and then works."""
    if record.name == "no_server":
        if record.marks.get("own_server"):
            return Failed("an action client only", "an action server, too", 0.0, causes.OWN_SERVER)
        return _crash(record, limits) or NotReached("the bridge was not tried with a server")
    if record.clicks and _goals_after(record, record.clicks[0]):
        return PASSED
    if not causes.has_client(record):
        return NotReached(causes.unconnected(record))
    clicked, wanted = record.marks.get("clicked", 0.0), "a goal once the server is running"
    return Failed(wanted, "no goal", clicked, causes.NOTHING_SENT, Kind.NO_GOAL)


@check("bridge", "no_server click replace frame", plot="track")
def bridge_alive(record: Record, limits: Limits) -> Verdict:
    """The bridge runs to the end without an exception."""
    if record.name == "frame" and causes.looks_up_too_early(record):
        return PASSED  # goal_frame tells it
    return _crash(record, limits) or PASSED


def _crash(record: Record, limits: Limits) -> Optional[Failed]:
    for verdict in (stays_alive(record, limits), no_exception(record, limits)):
        if isinstance(verdict, Failed):
            return verdict
    return None


@check("bridge", "frame", plot="track")
def goal_frame(record: Record, limits: Limits) -> Verdict:
    """A goal given in another frame is transformed to odom (the handout's closing question)."""
    if not record.clicks:
        return NotReached("there was no click")
    for number, click in enumerate(record.clicks):
        goals = _goals_of(record, number)
        if not goals:
            cause = (
                f"The click is newer than the newest transform from {click.frame} to odom, as in the lab, so tf2 "
                "raised an ExtrapolationException: give transform() a timeout, as in buffer.transform(msg, 'odom', "
                "rospy.Duration(1)), or ask for the newest transform with rospy.Time(0)"
                if causes.looks_up_too_early(record)
                else causes.NOT_FORWARDED
            )
            return Failed(f"a goal for the click in {click.frame}", "no goal", click.time, cause, Kind.NO_GOAL)
        goal = goals[-1]
        if not causes.distance(goal, click.odom_x, click.odom_y) <= causes.FRAME_TOLERANCE:
            cause = causes.other_position(record, click, goal)
            wanted = f"x {click.odom_x:.2f} y {click.odom_y:.2f} in odom"
            return Failed(wanted, f"x {goal.x:.2f} y {goal.y:.2f}", goal.time, cause, Kind.OTHER_POSITION)
    return PASSED
